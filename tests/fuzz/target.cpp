// SPDX-License-Identifier: Apache-2.0
#include "fuzz/target.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "error.h"
#include "parallel/tiles.h"

namespace ssdo::fuzz {
namespace {

bool is_for_inputs(ExitCode code) {
  return code == ExitCode::usage || code == ExitCode::input || code == ExitCode::layer;
}

void write_seeds(const std::filesystem::path& folder) {
  int number = 0;
  for (const std::string& seed : seeds())
    std::ofstream(folder / ("seed-" + std::to_string(number++)), std::ios::binary) << seed;
}

}  // namespace

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "FINDING: %s\n", what);
  std::abort();
}

void may_refuse(const std::function<void()>& read) {
  try {
    read();
  } catch (const Error& error) {
    require(is_for_inputs(error.code), error.what());
    require(*error.what() != '\0', "an error without a message");
  } catch (const std::exception& error) {
    require(false, error.what());
  }
}

}  // namespace ssdo::fuzz

/// A machine of 128 MiB: a larger frame is refused, and where there is more memory it may be an
/// honest one that packs well, which takes a minute with sanitizers. glibc has the real function by
/// this name too; sanitizers ask for the size of a page before they are ready to follow a call.
extern "C" long __sysconf(int name);
extern "C" __attribute__((no_sanitize("all"))) long sysconf(int name) noexcept {
  return name == _SC_PHYS_PAGES ? (1 << 27) / __sysconf(_SC_PAGESIZE) : __sysconf(name);
}

/// With `--seeds FOLDER` alone, writes the seeds there and exits.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  if (*argc == 3 && std::strcmp((*argv)[1], "--seeds") == 0) {
    ssdo::fuzz::write_seeds((*argv)[2]);
    std::exit(0);
  }
  // Threads would make the order of branches, which libFuzzer follows, one of chance.
  static const ssdo::ThreadLimit one_thread(1);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  ssdo::fuzz::read_input({data, size});
  return 0;
}
