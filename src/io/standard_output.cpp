// SPDX-License-Identifier: Apache-2.0
#include "io/standard_output.h"

#include <cerrno>
#include <cstdio>

#include "error.h"

namespace ssdo {

void print_out(std::string_view text) {
  const bool written =
      std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!written && errno != EPIPE)
    throw Error(ExitCode::output, "standard output cannot be written; is its disk full?");
}

}  // namespace ssdo
