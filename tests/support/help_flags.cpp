// SPDX-License-Identifier: Apache-2.0
#include "support/help_flags.h"

#include <gtest/gtest.h>

#include <regex>
#include <sstream>

#include "support/run_tool.h"

namespace ssdo::test {

std::set<std::string> flags_of_help(const std::vector<std::string>& arguments) {
  const Finished done = run_tool(arguments);
  EXPECT_EQ(done.code, 0) << done.err;
  // CLI11 2.6 leaves room for a letter, writes headings in capitals, and indents the options of
  // commands, which follow, no more than those of the tool.
  static const std::regex declared(R"(^  (?:-\w, *| {8})?(--[a-z][a-z-]*))");
  std::set<std::string> flags;
  std::istringstream lines(done.out);
  for (std::string line; std::getline(lines, line);) {
    if (line == "Subcommands:" || line == "SUBCOMMANDS:") break;
    std::smatch found;
    if (std::regex_search(line, found, declared)) flags.insert(found[1]);
  }
  return flags;
}

}  // namespace ssdo::test
