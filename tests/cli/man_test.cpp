// SPDX-License-Identifier: Apache-2.0
//
// The man pages against the binary: both know the same flags and parameters, and the pages render.
#include <gmock/gmock.h>

#include <cstdio>
#include <filesystem>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>

#include "support/help_flags.h"
#include "support/run_tool.h"
#include "support/temp_dir.h"

namespace ssdo::test::man_test {
namespace {

using Flags = std::set<std::string>;

const std::string kManual = std::string(SSDO_SOURCE_DIR) + "/man/ssdo.1",
                  kMethods = std::string(SSDO_SOURCE_DIR) + "/man/ssdo-methods.7",
                  kFarm = std::string(SSDO_SOURCE_DIR) + "/man/ssdo-farm.7";

/// A page as groff reads it, with \- for a dash turned into one.
std::string page(const std::string& path) {
  return std::regex_replace(read_file(path), std::regex(R"(\\-)"), "-");
}

Flags flags_of_binary() {
  Flags flags = flags_of_help({"--help-all"});
  flags.merge(flags_of_help({"info", "--help"}));
  flags.merge(flags_of_help({"compare", "--help"}));
  flags.merge(flags_of_help({"bench", "--help"}));
  return flags;
}

/// The flags in the tags of the page's paragraphs: the lines after .TP and .TQ.
Flags flags_of_headings() {
  static const std::regex flag("--[a-z][a-z-]*");
  Flags flags;
  std::istringstream lines(page(kManual));
  bool is_tag = false;
  for (std::string line; std::getline(lines, line);) {
    for (std::sregex_iterator it(line.begin(), line.end(), flag), end; is_tag && it != end; ++it) {
      flags.insert(it->str());
    }
    is_tag = line.starts_with(".TP") || line.starts_with(".TQ");
  }
  return flags;
}

/// How groff ended, and what it complained of.
struct Rendered {
  int status = -1;
  std::string warnings;
};

Rendered render(const std::string& path) {
  Rendered rendered;
  const std::string command = "groff -man -t -Tutf8 -ww '" + path + "' 2>&1 >/dev/null";
  FILE* groff = popen(command.c_str(), "r");
  if (!groff) return rendered;
  for (int c; (c = std::fgetc(groff)) != EOF;) rendered.warnings += char(c);
  rendered.status = pclose(groff);
  return rendered;
}

TEST(ManPage, HasTheFlagsOfTheHelpAndNoOthers) {
  const Flags binary = flags_of_binary();
  for (const char* known : {"--help", "--output", "--method", "--stats", "--json"}) {
    EXPECT_THAT(binary, testing::Contains(known)) << "the help is not read as it should be";
  }
  EXPECT_EQ(flags_of_headings(), binary);
}

/// Those in ssdo-farm(7) that are not ours, but of sbatch, parallel, make and apt-get.
const Flags kOfOthers = {"--array",  "--cpus-per-task", "--dependency", "--mem",
                         "--joblog", "--resume-failed", "--keep-going", "--no-install-recommends"};

TEST(ManPage, MentionsNoFlagThatDoesNotExist) {
  Flags binary = flags_of_binary();
  binary.insert(kOfOthers.begin(), kOfOthers.end());
  static const std::regex flag("(?:^|[^-\\w])(--[a-z][a-z-]*)");
  const std::string text = page(kManual) + page(kMethods) + page(kFarm);
  for (std::sregex_iterator it(text.begin(), text.end(), flag), end; it != end; ++it) {
    EXPECT_THAT(binary, testing::Contains((*it)[1].str()));
  }
}

TEST(ManPage, HasTheParametersOfTheMethods) {
  const Finished done = run_tool({"--list-methods"});
  static const std::regex parameter(R"(\n  ([a-z-]+) +([0-9a-z.e+-]+)  )");
  const std::string text = page(kMethods);
  int count = 0;
  for (std::sregex_iterator it(done.out.begin(), done.out.end(), parameter), end; it != end; ++it) {
    const std::string heading = ".BR " + (*it)[1].str() + " \" = " + (*it)[2].str() + "\"\n";
    EXPECT_THAT(text, testing::HasSubstr(heading));
    ++count;
  }
  EXPECT_GT(count, 0);
}

/// The commands of SYSTEMS OF THE SOURCES, each as words.
std::vector<std::vector<std::string>> commands_of_sources() {
  std::string text = std::regex_replace(page(kMethods), std::regex(R"(\\e\n)"), " ");
  text = text.substr(std::min(text.find(".SH SYSTEMS OF THE SOURCES"), text.size()));
  std::istringstream lines(text);
  std::vector<std::vector<std::string>> commands;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("ssdo ")) continue;
    std::istringstream words(line);
    commands.emplace_back(std::istream_iterator<std::string>(words),
                          std::istream_iterator<std::string>());
  }
  return commands;
}

TEST(ManPage, ItsCommandsForTheSystemsOfTheSourcesRun) {
  const auto commands = commands_of_sources();
  EXPECT_EQ(commands.size(), 9u) << "one for each system, and two of ssao";
  const TempDir folder;
  std::filesystem::create_directory_symlink(data(""), folder / "data");
  for (const std::vector<std::string>& command : commands) {
    SCOPED_TRACE(testing::PrintToString(command));
    EXPECT_THAT(command, testing::IsSupersetOf({"--method", "--filter", "source"}));
    std::vector<std::string> arguments(command.begin() + 1, command.end());
    arguments.push_back("--dry-run");
    const Finished done = run_tool(arguments, {.folder = folder.path()});
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_THAT(done.err, testing::HasSubstr(": that of the method's source"));
    EXPECT_THAT(done.err, testing::Not(testing::HasSubstr("warning")));
  }
}

TEST(ManPage, RendersWithoutWarnings) {
  for (const std::string& path : {kManual, kMethods, kFarm}) {
    const Rendered rendered = render(path);
    EXPECT_EQ(rendered.status, 0) << rendered.warnings;
    EXPECT_EQ(rendered.warnings, "") << path;
  }
}

}  // namespace
}  // namespace ssdo::test::man_test
