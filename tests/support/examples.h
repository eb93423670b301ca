// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace ssdo::test {

/// What a user pastes into a shell: the lines of one block of a document.
struct Example {
  std::string document;
  std::string text;
};

/// The blocks of README files that are indented by four blanks, the `spans` that are a whole
/// command of ssdo or oiiotool, the blocks between .EX and .EE of the man pages, and the commands
/// of --help.
std::vector<Example> examples();

}  // namespace ssdo::test
