// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace ssdo {

/// What the process tells the script that called it. Contract: man ssdo, EXIT STATUS.
enum class ExitCode {
  done = 0,
  failed = 1,  ///< processing failed
  usage = 2,   ///< the command line asks for something that does not exist
  input = 3,   ///< an input is missing or cannot be read
  layer = 4,   ///< a needed layer is missing or ambiguous
  output = 5,  ///< an output could not be written or may not be replaced
  interrupted = 130,
  terminated = 143,
};

/// The one exception type of the tool. The message is a single line that names the file, the
/// thing, what was found instead and what to do; main prints it and exits with `code`.
struct Error : std::runtime_error {
  Error(ExitCode exit_code, const std::string& message)
      : std::runtime_error(message), code(exit_code) {}
  ExitCode code;
};

}  // namespace ssdo
