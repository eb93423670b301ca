// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <exception>
#include <new>

#include "batch.h"
#include "error.h"
#include "estimators/registry.h"
#include "io/safe_file.h"
#include "options.h"

namespace {

ssdo::ExitCode run(int argc, char** argv) {
  const ssdo::ParsedOptions parsed = ssdo::parse_options(argc, argv);
  if (parsed.print) {
    fmt::print("{}", *parsed.print);
    return ssdo::ExitCode::done;
  }
  if (parsed.options.command == ssdo::Command::list_methods) {
    fmt::print("{}", ssdo::describe_methods());
    return ssdo::ExitCode::done;
  }
  return ssdo::run_batch(parsed.options);
}

}  // namespace

int main(int argc, char** argv) {
  ssdo::remove_temporaries_on_signals();
  try {
    return int(run(argc, argv));
  } catch (const ssdo::Error& e) {
    fmt::print(stderr, "ssdo: {}\n", e.what());
    return int(e.code);
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "ssdo: not enough memory for this frame\n");
  } catch (const std::exception& e) {
    fmt::print(stderr, "ssdo: unexpected: {}\n", e.what());
  }
  return int(ssdo::ExitCode::failed);
}
