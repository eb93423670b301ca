// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "cli/options.h"

namespace ssdo {

/// What the command line asks for: work, or a text to print (--help, --completions).
struct ParsedOptions {
  Options options;
  std::optional<std::string> print;
};

/// Parses and validates. Errors: ExitCode::usage, one line.
ParsedOptions parse_options(int argc, const char* const* argv);

}  // namespace ssdo
