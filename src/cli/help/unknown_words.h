// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "error.h"

namespace CLI {
class App;
}

namespace ssdo {

/// The command that INPUT may be a misspelling of, where the line names no command.
std::optional<std::string> misspelt_command(const CLI::App& app);

/// The error for what `app` did not understand of its command line: a command, or else an option,
/// or else a word too many, with the name that may be meant.
Error unknown_words(const CLI::App& app);

}  // namespace ssdo
