// SPDX-License-Identifier: Apache-2.0
//
// An option that changes nothing is no silent success: issue 20.
#include <gmock/gmock.h>

#include <fstream>

#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test::ineffective_options_test {
namespace {

using testing::HasSubstr;

class IdleOptions : public testing::Test {
 protected:
  IdleOptions() {
    FramePart part = frame_of(small_picture());
    write_frame(path("in.exr"), part);
    part.channels.erase("ViewLayer.Depth.Z");
    write_frame(path("no_depth.exr"), part);
  }
  std::string path(const std::string& name) const { return dir_ / name; }
  Finished run(const std::string& in, std::vector<std::string> flags) const {
    flags.insert(flags.begin(),
                 {path(in), "-o", path("out.exr"), "--overwrite", "--slices", "1", "--steps", "1"});
    return run_tool(flags);
  }
  TempDir dir_;
};

TEST_F(IdleOptions, AreWarnedOf) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> idle = {
      {{"--motion-scale", "-1,-1"}, "--motion-scale has no effect"},
      {{"--env-rotate", "30"}, "--env-rotate has no effect"},
      {{"--env-up", "z", "--env", "0.5", "--prior", "rules"}, "--env-up has no effect"},
      {{"--quality", "final"}, "--slices and --steps stand in its place"},
      {{"--bits", "16"}, "--bits has no effect"},
      {{"--view", "Raw"}, "--view has no effect"},
      {{"--compose", "relight", "--products", "ao"}, "--compose has no effect: no output has"},
      {{"--crop"}, "--crop has no effect: the frame has no pixels beyond"},
      {{"--bounces", "2", "--products", "ao,direct"}, "--bounces has no effect: no output has"},
      {{"--set", "roughness=0.3"}, "--set roughness has no effect: no output has reflection"},
      {{"--set", "ior=2"}, "--set ior has no effect: no output has specular"},
      {{"--aov", "specular-color=ViewLayer.DiffCol"},
       "--aov specular-color has no effect: no output has specular"},
  };
  for (const auto& [flags, says] : idle) {
    const Finished done = run("in.exr", flags);
    EXPECT_EQ(done.code, 0) << done.err;
    EXPECT_THAT(done.error_line(), HasSubstr(says));
    EXPECT_THAT(done.error_line(), HasSubstr("warning: "));
    std::vector<std::string> quiet = flags;
    quiet.push_back("-q");
    EXPECT_EQ(run("in.exr", quiet).err, "");
  }
  for (const std::vector<std::string>& flags :
       {std::vector<std::string>{"--background-depth", "100"}, {"--depth-kind", "ray"}}) {
    EXPECT_THAT(run("no_depth.exr", flags).error_line(), HasSubstr(flags[0] + " has no effect"));
    EXPECT_EQ(run("in.exr", flags).err, "");
  }
  const auto picture = [&](std::vector<std::string> flags) {
    flags.insert(flags.begin(), {path("in.exr"), "-o", path("out.jpg"), "--overwrite"});
    return run_tool(flags).error_line();
  };
  for (const std::vector<std::string>& flags : {std::vector<std::string>{"--bits", "16"},
                                                {"--pixel-type", "float"},
                                                {"--keep-channels"},
                                                {"--crop"},
                                                {"--compression", "zip"},
                                                {"--quality", "draft", "--method", "ssao"},
                                                {"--seed", "1", "--method", "msvo"},
                                                {"--offscreen", "open", "--method", "ssdo"}}) {
    EXPECT_THAT(picture(flags), HasSubstr(flags[0] + " has no effect"));
  }
  const Finished save = run_tool({path("in.exr"), "--save", "ao=" + path("ao.exr"), "--products",
                                  "ao,direct", "--bounces", "0"});
  EXPECT_THAT(save.error_line(), HasSubstr("--products has no effect"));
}

/// Composite occlude takes how much of the light arrives: neither how bright it is nor bounces.
TEST_F(IdleOptions, OfLightInCompositeOccludeAreWarnedOf) {
  const std::string sky = data("environments/sky.exr");
  const auto errors = [&](std::vector<std::string> flags) {
    flags.insert(flags.begin(), {data("still_life.exr"), "--overwrite", "--dry-run", "--env", sky,
                                 "--aov", "ambient=" + data("still_life_beauty.exr") + ":Ambient"});
    return run_tool(flags).err;
  };
  struct Case {
    const char* option;
    std::vector<std::string> outputs;
    bool idle;
  };
  const std::string png = path("o.png"), exr = path("o.exr"), ao = "ao=" + png;
  const Case cases[] = {
      {"--bounces", {"-o", png}, true},
      {"--bounces", {"-o", exr, "--products", "composite,direct"}, true},
      {"--bounces", {"-o", exr, "--products", "composite,bounce"}, false},
      {"--bounces", {"-o", exr}, false},
      {"--bounces", {"-o", png, "--save", "bounce=" + exr}, false},
      {"--bounces", {"-o", png, "--compose", "relight"}, false},
      {"--env-exposure", {"-o", png}, true},
      {"--env-exposure", {"--save", ao}, true},
      {"--env-exposure", {"-o", exr, "--products", "composite,direct"}, false},
      {"--env-exposure", {"-o", exr, "--products", "all"}, false},
      {"--env-exposure", {"-o", png, "--compose", "relight"}, false},
  };
  for (const Case& c : cases) {
    std::vector<std::string> flags = c.outputs;
    flags.insert(flags.end(), {c.option, "2"});
    SCOPED_TRACE(testing::PrintToString(flags));
    const std::string says = std::string("warning: ") + c.option + " has no effect";
    EXPECT_EQ(errors(flags).find(says) != std::string::npos, c.idle) << errors(flags);
    EXPECT_THAT(errors(c.outputs), testing::Not(HasSubstr(says))) << "it is not given";
  }
}

TEST_F(IdleOptions, WithAnEffectAreNot) {
  for (const std::vector<std::string>& flags :
       {std::vector<std::string>{"--env", data("environments/sky.exr"), "--env-rotate", "30",
                                 "--env-up", "z"},
        {"-o", path("out.png"), "--bits", "16", "--view", "Raw", "--pixel-type", "float"},
        {"--offscreen", "open", "--bounces", "2", "--seed", "1"},
        {"--prior", "learned", "--products", "ao"},
        {"--env", "0.5", "--env-up", "z", "--light", "distant direction=0,0,-1"},
        {"--set", "roughness=0.3", "--products", "reflection"},
        {"--set", "roughness=0.3", "--set", "ior=2", "--products", "specular"}}) {
    const Finished done = run("in.exr", flags);
    EXPECT_EQ(done.code, 0);
    EXPECT_EQ(done.err, "");
  }
}

/// A file of options serves jobs of many kinds.
TEST_F(IdleOptions, OfAConfigFileAreNot) {
  std::ofstream(path("o.toml")) << "motion-scale = \"-1,-1\"\nbits = 16\n";
  EXPECT_EQ(run("in.exr", {"--config", path("o.toml")}).err, "");
}

/// Two answers to one question are an error.
TEST_F(IdleOptions, ThatContradictEachOtherAreRefused) {
  std::ofstream(path("c.json")) << R"({"hfov_deg": 40})";
  for (const std::vector<std::string>& flags :
       {std::vector<std::string>{"--camera", path("c.json"), "--fov", "40"},
        {"--camera", path("c.json"), "--ortho", "4"},
        {"-q", "-v"}}) {
    const Finished done = run("in.exr", flags);
    EXPECT_EQ(done.code, 2) << flags[0];
    EXPECT_THAT(done.error_line(), HasSubstr("excludes")) << flags[0];
  }
}

}  // namespace
}  // namespace ssdo::test::ineffective_options_test
