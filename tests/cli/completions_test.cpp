// SPDX-License-Identifier: Apache-2.0
//
// The scripts of --completions in real shells: what a tab offers, and what it makes of the line.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "support/frame_file.h"
#include "support/help_flags.h"
#include "support/run_tool.h"

namespace ssdo::test::completions_test {
namespace {

using testing::Contains;
using testing::IsSupersetOf;
using Names = std::set<std::string>;

/// What a tab does at the end of a line.
struct Completed {
  Names offers;      ///< as the shell has them: of a list, bash offers all of it and zsh its end
  std::string line;  ///< after it, without the blank, "=" or "," that a shell adds
};

class Completions : public testing::TestWithParam<std::string> {
 protected:
  Completions() {
    const Finished done = run_tool({"--completions", GetParam()});
    EXPECT_EQ(done.code, 0) << done.err;
    std::filesystem::create_directories(dir_ / "work/renders");
    std::ofstream(script()) << done.out;
    for (const char* name : {"shot.exr", "beauty.exr", "notes.txt", "view.json", "two words.exr"})
      std::ofstream(dir_ / "work" / name) << "";
  }

  std::string script() const { return dir_ / (GetParam() == "zsh" ? "_ssdo" : "ssdo"); }

  /// Types the lines, each with a tab at its end, in a folder with a few files.
  std::map<std::string, Completed> complete(const std::vector<std::string>& lines) const {
    const std::string driver = std::string(SSDO_SOURCE_DIR) + "/tests/cli/complete." + GetParam();
    std::vector<std::string> words = {GetParam(), driver, script()};
    words.insert(words.end(), lines.begin(), lines.end());
    const std::string path = tool_path().parent_path().string() + ":" + getenv("PATH");
    const Finished done = run_tool(
        words, {.variables = {{"PATH", path}}, .binary = "/usr/bin/env", .folder = dir_ / "work"});
    std::map<std::string, Completed> all;
    std::istringstream in(done.out);
    std::size_t next = 0;
    for (std::string line; std::getline(in, line) && next < lines.size();) {
      Completed& here = all[lines[next]];
      const auto text = line.substr(std::min(line.find(' ') + 1, line.size()));
      if (line.starts_with("offer: ")) here.offers.insert(text);
      if (!line.starts_with("line: ")) continue;
      here.line = std::regex_replace(text, std::regex("[ =,]+$"), "");
      ++next;
    }
    EXPECT_EQ(next, lines.size()) << done.out << done.err;
    return all;
  }

  Names offers(const std::string& line) const { return complete({line})[line].offers; }

  const TempDir dir_;
};

/// Without what is not a flag: zsh offers "-h" beside "--help".
Names long_flags(Names offers) {
  std::erase_if(offers, [](const std::string& offer) { return !offer.starts_with("--"); });
  return offers;
}

TEST_P(Completions, FinishWhatIsBegun) {
  const std::map<std::string, std::string> finished = {
      {"ssdo --meth", "ssdo --method"},
      {"ssdo inf", "ssdo info"},
      {"ssdo sh", "ssdo shot.exr"},
      {"ssdo info sh", "ssdo info shot.exr"},
      {"ssdo shot.exr --qua", "ssdo shot.exr --quality"},
      {"ssdo --quality dr", "ssdo --quality draft"},
      {"ssdo --quality=dr", "ssdo --quality=draft"},
      {"ssdo --method ssao-r", "ssdo --method ssao-range"},
      {"ssdo --filter ga", "ssdo --filter gaussian"},
      {"ssdo --compression dwaa", "ssdo --compression dwaa"},
      {"ssdo --radius a", "ssdo --radius auto"},
      {"ssdo --products ao,ben", "ssdo --products ao,bent"},
      {"ssdo --products al", "ssdo --products all"},
      {"ssdo bench shot.exr --methods ssdo,gt", "ssdo bench shot.exr --methods ssdo,gtao"},
      {"ssdo --save gue", "ssdo --save guessed"},
      {"ssdo --save ao=no", "ssdo --save ao=notes.txt"},
      {"ssdo --aov norm", "ssdo --aov normal"},
      {"ssdo --aov normal=be", "ssdo --aov normal=beauty.exr"},
      {"ssdo --camera v", "ssdo --camera view.json"},
      {"ssdo --method gtao --set multi", "ssdo --method gtao --set multi-bounce"},
      {"ssdo --method=gtao --set multi", "ssdo --method=gtao --set multi-bounce"},
      {"ssdo --set multi", "ssdo --set multi"},  // no parameter of the default method
      {"ssdo -o shot.exr sh", "ssdo -o shot.exr shot.exr"},
      {"ssdo --seed sh", "ssdo --seed sh"},
  };
  std::vector<std::string> lines;
  for (const auto& [line, end] : finished) lines.push_back(line);
  auto all = complete(lines);
  for (const auto& [line, end] : finished) EXPECT_EQ(all[line].line, end) << line;
}

TEST_P(Completions, OfferWhatFits) {
  EXPECT_EQ(offers("ssdo --env-up "), (Names{"auto", "y", "z"}));
  EXPECT_EQ(offers("ssdo --camera "), (Names{"renders", "view.json"}));
  EXPECT_EQ(offers("ssdo info "), (Names{"beauty.exr", "renders", "shot.exr", "two words.exr"}));
  EXPECT_THAT(offers("ssdo "), IsSupersetOf({"info", "bench", "compare", "shot.exr", "renders"}));
  EXPECT_THAT(offers("ssdo "), testing::Not(Contains("notes.txt")));
  EXPECT_THAT(offers("ssdo -o "), Contains("notes.txt"));
  EXPECT_THAT(offers("ssdo compare shot.exr "), Contains("notes.txt"));
  EXPECT_THAT(offers("ssdo --method ssdo --set "), IsSupersetOf({"samples=", "bias="}));
  EXPECT_THAT(offers("ssdo --method msvo --set "), testing::Not(Contains("samples=")));
  EXPECT_EQ(offers("ssdo --seed "), Names());
}

TEST_P(Completions, OfferTheOptionsOfTheCommand) {
  const Names all = flags_of_help({"--help-all"});
  EXPECT_EQ(long_flags(offers("ssdo --")), all);
  Names info = all;
  info.insert("--json");
  EXPECT_EQ(long_flags(offers("ssdo info --")), info);
  EXPECT_EQ(long_flags(offers("ssdo compare --")), flags_of_help({"compare", "--help"}));
  const Names bench = long_flags(offers("ssdo bench --"));
  EXPECT_THAT(bench, IsSupersetOf(flags_of_help({"bench", "--help"})));
  EXPECT_THAT(bench, IsSupersetOf({"--env", "--radius"}));
  for (const char* refused : {"--method", "--output", "--frames"})
    EXPECT_THAT(bench, testing::Not(Contains(refused)));
}

TEST_P(Completions, OfferTheLayersOfTheFrame) {
  write_frame(dir_ / "work/frame.exr", frame_of(small_picture()));
  const Names layers = {"ViewLayer.DiffCol", "ViewLayer.Normal", "ViewLayer.Position"};
  EXPECT_THAT(offers("ssdo frame.exr --aov normal="), IsSupersetOf(layers));
  EXPECT_THAT(offers("ssdo frame.exr --aov normal="),
              testing::AllOf(Contains("shot.exr"), testing::Not(Contains("ViewLayer.Depth"))));
  EXPECT_THAT(offers("ssdo frame.exr --aov depth="), Contains("ViewLayer.Depth"));
  EXPECT_THAT(offers("ssdo --aov normal="), testing::Not(Contains("ViewLayer.Normal")));
  for (const std::string start :
       {"ssdo frame.exr --aov normal=", "ssdo info frame.exr --aov=normal="}) {
    const std::string line = start + "ViewLayer.N";
    EXPECT_EQ(complete({line})[line].line, start + "ViewLayer.Normal");
  }
}

/// The choices that the help shows as --flag {A,B}.
TEST_P(Completions, OfferTheChoicesOfEveryOption) {
  const std::string help = run_tool({"--help-all"}).out;
  static const std::regex choice(R"((--[a-z-]+) \{([^}]+)\})");
  std::map<std::string, Names> choices;
  for (std::sregex_iterator it(help.begin(), help.end(), choice), end; it != end; ++it) {
    std::istringstream names((*it)[2]);
    for (std::string name; std::getline(names, name, ',');)
      choices["ssdo " + (*it)[1].str() + " "].insert(name);
  }
  EXPECT_GE(choices.size(), 8u);
  std::vector<std::string> lines;
  for (const auto& [line, names] : choices) lines.push_back(line);
  auto all = complete(lines);
  for (const auto& [line, names] : choices) EXPECT_EQ(all[line].offers, names) << line;
}

INSTANTIATE_TEST_SUITE_P(Shells, Completions, testing::Values("bash", "zsh"),
                         [](const auto& shell) { return shell.param; });

}  // namespace
}  // namespace ssdo::test::completions_test
