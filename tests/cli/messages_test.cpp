// SPDX-License-Identifier: Apache-2.0
//
// What is said, where and how loudly.
#include <ImfStringAttribute.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"
#include "support/terminal.h"

namespace ssdo::test::messages_test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class Messages : public testing::Test {
 protected:
  Messages() {
    FramePart part = frame_of(small_picture());
    write_frame(path("in.exr"), part);
    part.type = Imf::HALF;
    for (float& z : part.channels["ViewLayer.Depth.Z"].pixels) z = z > 1e9f ? INFINITY : z;
    write_frame(path("half.exr"), part);
  }
  std::string path(const std::string& name) const { return dir_ / name; }
  Finished run(const std::string& in, std::vector<std::string> flags) const {
    flags.insert(flags.begin(), {path(in), "-o", path("out.exr"), "--overwrite"});
    return run_tool(flags);
  }
  TempDir dir_;
};

TEST_F(Messages, NothingIsSaidOfASuccess) {
  const Finished done = run("in.exr", {});
  EXPECT_EQ(done.code, 0);
  EXPECT_EQ(done.out, "");
  EXPECT_EQ(done.err, "");
}

TEST_F(Messages, AWarningIsOneLineOnStandardError) {
  const Finished done = run("half.exr", {});
  EXPECT_EQ(done.code, 0);
  EXPECT_EQ(done.out, "");
  EXPECT_THAT(done.error_line(), testing::StartsWith("ssdo: " + path("half.exr") + ": warning: "));
  EXPECT_EQ(run("half.exr", {"-q"}).err, "");
  const Finished failed = run("none.exr", {"-q"});
  EXPECT_EQ(failed.code, 3);
  EXPECT_THAT(failed.error_line(), HasSubstr("none.exr")) << "errors are said all the same";
}

/// A first run did not learn why there is no composite, nor that normals are not those of N.
TEST_F(Messages, WhatFollowsFromMissingLayersIsSaid) {
  const auto without = [&](const std::string& layer, const std::string& renamed) {
    FramePart part = frame_of(small_picture());
    std::map<std::string, Plane<float>> channels;
    for (auto& [name, plane] : part.channels) {
      if (name.find(layer) == name.npos)
        channels[name] = std::move(plane);
      else if (!renamed.empty())
        channels[renamed + name.substr(name.rfind('.'))] = std::move(plane);
    }
    part.channels = std::move(channels);
    write_frame(path("part.exr"), part);
    return run("part.exr", {"--slices", "1", "--steps", "1"});
  };
  EXPECT_THAT(without("DiffCol", "").error_line(),
              HasSubstr("no layer for albedo found by name: no bounce and no composite; name one "
                        "with --aov albedo=LAYER"));
  EXPECT_EQ(run("part.exr", {"--products", "ao"}).err, "") << "needs none";
  EXPECT_EQ(run("part.exr", {"-q"}).err, "");
  EXPECT_THAT(without("DiffCol", "my_alb_pass").error_line(), HasSubstr("if 'my_alb_pass' is"));
  EXPECT_THAT(
      without("Normal", "").error_line(),
      HasSubstr("no layer for normal found by name: normals are rebuilt from the position"));
}

TEST_F(Messages, ARadiusInAnotherUnitIsWarnedOf) {
  const auto warns = [&](const std::string& radius) {
    return run("in.exr", {"--dry-run", "--radius", radius}).err;
  };
  EXPECT_THAT(warns("0.001"), HasSubstr("--radius 0.001 is less than a pixel, which is "));
  EXPECT_THAT(warns("5000"), HasSubstr("--radius 5000 is more than all that the frame shows"));
  for (const char* radius : {"0.5", "inf", "auto"})
    EXPECT_THAT(warns(radius), Not(HasSubstr("warning   --radius"))) << radius;
}

/// Albedo in sRGB was taken as linear without a word.
TEST_F(Messages, EncodedColoursOfAFrameAreWarnedOf) {
  FramePart part = frame_of(small_picture());
  part.extra.insert("oiio:ColorSpace", Imf::StringAttribute("sRGB"));
  write_frame(path("part.exr"), part);
  EXPECT_THAT(run("part.exr", {}).error_line(),
              HasSubstr("colours are sRGB, which is not linear, and albedo is taken as linear"));
}

/// How much is guessed was said to those only who asked.
TEST_F(Messages, APlainRunOfOneFrameSaysWhatIsGuessed) {
  const std::vector<std::string> corner = {data("room_corner.exr"),
                                           "-o",
                                           path("out.exr"),
                                           "--overwrite",
                                           "--slices",
                                           "1",
                                           "--steps",
                                           "1",
                                           "--products",
                                           "ao"};
  const std::string said = run_on_terminal(corner).out;  // run_tool() takes the line away
  EXPECT_THAT(said,
              testing::ContainsRegex("room_corner.exr: 0.[67][0-9] of all directions are guessed; "
                                     "render"));
  std::vector<std::string> quiet = corner;
  quiet.push_back("-q");
  EXPECT_EQ(run_on_terminal(quiet).out, "");
}

TEST_F(Messages, AVerboseRunNamesWhatItChose) {
  const Finished done =
      run("half.exr", {"-v", "-o", path("out.png"), "--env", data("environments/studio.exr")});
  EXPECT_EQ(done.code, 0);
  EXPECT_EQ(done.out, "");
  for (const char* word : {"ViewLayer.Position.X", "ViewLayer.DiffCol.R", "fitted from P", "radius",
                           "64 samples", "studio.exr", "16 bits", "ACES SDR Video"}) {
    EXPECT_THAT(done.err, HasSubstr(word));
  }
}

TEST_F(Messages, AMethodWithoutARadiusClaimsNone) {
  const Finished told = run_tool({"info", path("in.exr"), "--method", "msvo"});
  EXPECT_EQ(told.code, 0) << told.err;
  EXPECT_THAT(told.out, Not(HasSubstr("radius")));
  const auto plan_of = [&](const std::string& method) {
    return parse_json(run_tool({"info", path("in.exr"), "--json", "--method", method}).out)["plan"];
  };
  EXPECT_FALSE(plan_of("msvo").contains("radius"));
  EXPECT_TRUE(plan_of("sao").contains("radius"));
}

TEST_F(Messages, WithoutATerminalThereIsNoTerminalControl) {
  for (const std::vector<std::string>& flags :
       {std::vector<std::string>{}, {"-v"}, {"--progress", "auto"}, {"--radius", "x"}}) {
    const Finished done = run("half.exr", flags);
    EXPECT_GT(done.err.size(), 10u);
    EXPECT_EQ(done.err.find_first_of("\r\033\b\t"), std::string::npos) << done.err;
  }
  EXPECT_EQ(run_tool({"--help"}).out.find_first_of("\r\033\b"), std::string::npos);
}

TEST_F(Messages, ATerminalSeesABarThatGoesAway) {
  const std::vector<std::string> words = {data("room_corner.exr"), "-o", path("out.exr"),
                                          "--overwrite"};
  const Finished seen = run_on_terminal(words);
  EXPECT_EQ(seen.code, 0);
  EXPECT_THAT(seen.out, HasSubstr("[#"));
  EXPECT_THAT(seen.out, HasSubstr("%"));
  EXPECT_THAT(seen.out, HasSubstr("\r\033[Kssdo: ")) << "the line is left empty for the next";
  for (const std::vector<std::string>& flags :
       {std::vector<std::string>{"-q"}, {"--progress", "none"}}) {
    std::vector<std::string> quiet = words;
    quiet.insert(quiet.end(), flags.begin(), flags.end());
    EXPECT_EQ(run_on_terminal(quiet).out.find('\033'), std::string::npos) << flags[0];
  }
}

/// The numbers in the lines of a progress style, each of which has to match it whole.
std::vector<int> percents(const std::string& text, const std::regex& style) {
  std::vector<int> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    EXPECT_TRUE(std::regex_match(line, match, style)) << line;
    if (!match.empty()) found.push_back(std::stoi(match[1]));
  }
  return found;
}

TEST_F(Messages, ProgressRisesToAHundred) {
  for (const auto& [style, line] :
       {std::pair<std::string, std::string>{"tractor", "TR_PROGRESS ([0-9]{3})%"},
        {"alfred", "ALF_PROGRESS ([0-9]+)%"},
        {"openjd", "openjd_progress: ([0-9]+)"}}) {
    const Finished done = run_tool(
        {data("room_corner.exr"), "-o", path("out.exr"), "--overwrite", "--progress", style});
    EXPECT_EQ(done.code, 0);
    EXPECT_EQ(done.err, "");
    const std::vector<int> told = percents(done.out, std::regex(line));
    ASSERT_GT(told.size(), 5u) << "not at the end alone";
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end())) << done.out;
    EXPECT_EQ(std::adjacent_find(told.begin(), told.end()), told.end()) << "no line twice";
    EXPECT_EQ(told.back(), 100);
  }
  EXPECT_EQ(run("in.exr", {"--progress", "none"}).out, "");
}

TEST_F(Messages, ADryRunAndInfoWriteNothing) {
  const std::vector<std::string> before = listing(dir_.path());
  const Finished dry = run_tool({path("in.exr"), "--dry-run"});
  EXPECT_EQ(dry.code, 0) << "needs no output";
  EXPECT_EQ(dry.out, "");
  EXPECT_EQ(run("in.exr", {"--dry-run"}).code, 0);
  const Finished info = run_tool({"info", path("in.exr"), "-o", path("out.exr")});
  EXPECT_EQ(info.code, 0);
  EXPECT_EQ(info.err, "");
  EXPECT_THAT(info.out, testing::EndsWith(dry.err)) << "both say the same below the listing";
  EXPECT_EQ(listing(dir_.path()), before);
}

TEST_F(Messages, InfoListsEveryChannelWithItsType) {
  const Finished done = run_tool({"info", path("half.exr"), "--json"});
  ASSERT_EQ(done.code, 0) << done.err;
  const json j = parse_json(done.out);
  EXPECT_EQ(j["file"], path("half.exr"));
  EXPECT_EQ(j["width"], 64);
  EXPECT_EQ(j["height"], 48);
  EXPECT_EQ(j["parts"].size(), 1u);
  EXPECT_EQ(j["parts"][0]["channels"].size(), 10u);
  EXPECT_EQ(j["parts"][0]["channels"][0]["name"], "ViewLayer.Depth.Z");
  EXPECT_EQ(j["parts"][0]["channels"][0]["type"], "half");
  EXPECT_EQ(j["layers"]["position"]["half"], true);
  EXPECT_EQ(j["bad_pixels"], 0);
}

}  // namespace
}  // namespace ssdo::test::messages_test
