// SPDX-License-Identifier: Apache-2.0
//
// --help fits a screen and says nothing that --help-all does not know; --help-all has everything.
#include <gmock/gmock.h>

#include <regex>
#include <sstream>

#include "support/help_flags.h"
#include "support/run_tool.h"

namespace ssdo::test::help_test {
namespace {

using testing::HasSubstr;

std::string help(const std::vector<std::string>& arguments) {
  const Finished done = run_tool(arguments);
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(done.err, "");
  return done.out;
}

std::set<std::string> flags_in(const std::string& text) {
  static const std::regex flag("--[a-z][a-z-]*");
  return {std::sregex_token_iterator(text.begin(), text.end(), flag), std::sregex_token_iterator()};
}

TEST(ShortHelp, FitsAScreen) {
  const std::string text = help({"--help"});
  int lines = 0;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line); ++lines) EXPECT_LE(line.size(), 80u) << line;
  EXPECT_LE(lines, 24);
  EXPECT_EQ(help({"-h"}), text);
}

TEST(ShortHelp, NamesTheCommandsAndOptionsThatExist) {
  const std::string text = help({"--help"});
  for (const char* line : {"ssdo INPUT -o", "ssdo info ", "ssdo bench ", "ssdo compare "})
    EXPECT_THAT(text, HasSubstr(line));
  const std::set<std::string> all = flags_of_help({"--help-all"}), named = flags_in(text);
  EXPECT_THAT(named, testing::IsSupersetOf({"--help-all", "--env", "--products", "--overwrite"}));
  for (const std::string& flag : named) EXPECT_THAT(all, testing::Contains(flag));
}

TEST(FullHelp, HasTheOptionsOfAllCommands) {
  const std::string text = help({"--help-all"});
  for (const char* option : {"--seed", "--list-methods", "--want", "--fail-above", "--json"})
    EXPECT_THAT(text, HasSubstr(option));
  EXPECT_EQ(help({"info", "--help-all"}), text) << "the same after a command";
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) EXPECT_LE(line.size(), 100u) << line;
}

TEST(HelpOfACommand, HasItsOptions) {
  EXPECT_THAT(flags_of_help({"info", "--help"}), testing::Contains("--json"));
  EXPECT_THAT(flags_of_help({"bench", "--help"}), testing::Contains("--want"));
  EXPECT_THAT(flags_of_help({"compare", "--help"}), testing::Contains("--mask"));
  for (const char* command : {"info", "bench"})
    EXPECT_THAT(help({command, "--help"}), HasSubstr("options of the main job"));
  EXPECT_THAT(help({"compare", "--help"}), testing::Not(HasSubstr("main job")));
}

}  // namespace
}  // namespace ssdo::test::help_test
