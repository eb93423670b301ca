// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <string_view>

#include "bench/run_bench.h"
#include "cli/parse_options.h"
#include "error.h"
#include "estimators/registry.h"
#include "io/files/safe_file.h"
#include "io/files/temporary_table.h"
#include "io/one_line.h"
#include "io/standard_output.h"
#include "jobs/batch.h"
#include "jobs/machine/memory.h"
#include "jobs/machine/resources.h"
#include "jobs/machine/threads.h"
#include "metrics/compare.h"

namespace {

void warn(const ssdo::ParsedOptions& parsed, const std::string& warning) {
  if (!parsed.options.verbosity.quiet) std::fprintf(stderr, "ssdo: warning: %s\n", warning.c_str());
}

ssdo::ExitCode run(int argc, char** argv) {
  const ssdo::ParsedOptions parsed = ssdo::parse_options(argc, argv);
  if (parsed.print) {
    ssdo::print_out(*parsed.print);
    return ssdo::ExitCode::done;
  }
  if (parsed.options.command == ssdo::Command::list_methods) {
    ssdo::print_out(ssdo::describe_methods());
    return ssdo::ExitCode::done;
  }
  for (const std::string& warning : parsed.options.warnings) warn(parsed, warning);
  // Never destroyed: without its limit TBB starts more threads, and ends the process if it cannot.
  static const ssdo::Resources& resources =
      *new ssdo::Resources(parsed.options.threads, parsed.options.mem_limit);
  if (const std::string warning = resources.warning(); !warning.empty()) warn(parsed, warning);
  if (parsed.options.command == ssdo::Command::compare) {
    const ssdo::CompareReport report = ssdo::compare(parsed.options.compare);
    ssdo::print_out(report.text);
    return report.code;
  }
  if (parsed.options.command == ssdo::Command::bench)
    return ssdo::run_bench(parsed.options, parsed.options.bench, resources);
  return ssdo::run_batch(parsed.options, resources);
}

/// Opens the standard streams that the caller has closed: else the first file to be written would
/// get the descriptor of standard output, and progress would go into the file.
void open_standard_streams() {
  int descriptor;
  while ((descriptor = open("/dev/null", O_RDWR)) >= 0 && descriptor <= STDERR_FILENO) {
  }
  close(descriptor);
}

/// Keeps the memory of freed planes for the next stage and frame. Memory that is returned to the
/// system comes back page by page, at 0.4 ms of CPU time per MB: a fifth of a 4K frame.
void keep_freed_memory() {
  mallopt(M_MMAP_MAX, 0);  // no mapping of its own for a plane, which would end with the plane
  mallopt(M_TRIM_THRESHOLD, INT_MAX);
  mallopt(M_ARENA_MAX, 1);  // what one thread has freed serves the others
}

/// The last words of a process that fails; what cannot be said (standard error is closed, or its
/// disk is full) does not change the exit code.
ssdo::ExitCode fail(ssdo::ExitCode code, const char* message) {
  std::fprintf(stderr, "ssdo: %s\n", ssdo::printable(message).c_str());
  return code;
}

/// Says why the exception that is being handled ends the process.
ssdo::ExitCode fail() {
  try {
    throw;
  } catch (const ssdo::Error& e) {
    return fail(e.code, e.what());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "ssdo: %s\n", ssdo::kNoMemory);  // without allocating
    return ssdo::ExitCode::failed;
  } catch (const std::exception& e) {
    // The standard library and TBB throw this where no thread starts.
    const bool no_thread =
        std::string_view(e.what()).find(std::strerror(EAGAIN)) != std::string_view::npos;
    return fail(ssdo::ExitCode::failed, no_thread ? ssdo::kNoThread : e.what());
  }
}

/// In place of abort() where an exception has nobody to catch it, as that of a destructor, or of a
/// library whose thread does not start.
[[noreturn]] void end_at_once() {
  ssdo::remove_temporaries();
  if (std::current_exception()) _exit(int(fail()));
  std::fprintf(stderr, "ssdo: %s\n", ssdo::kNoThread);
  _exit(int(ssdo::ExitCode::failed));
}

/// Before main(), since other initialisers of globals allocate.
[[maybe_unused]] const std::terminate_handler g_abort = std::set_terminate(end_at_once);

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  keep_freed_memory();
  ssdo::remove_temporaries_on_signals();
  ssdo::ExitCode code;
  try {
    code = run(argc, argv);
    ssdo::print_out("");  // progress lines that are still in the buffer
  } catch (...) {
    code = fail();
  }
  return int(code);
}
