// SPDX-License-Identifier: Apache-2.0
//
// Options from a file: every one of them has its effect, or the run is refused with file and line.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::config_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Config : public testing::Test {
 protected:
  Config() { write_frame(path("in.exr"), frame_of(small_picture())); }
  std::string path(const std::string& name) const { return dir_ / name; }
  void write(const std::string& text) const {
    std::ofstream(path("o.toml"), std::ios::binary) << text;
  }
  Finished dry_run(std::vector<std::string> flags = {}) const {
    flags.insert(flags.begin(), {path("in.exr"), "--dry-run", "-q", "--config", path("o.toml")});
    return run_tool(flags);
  }
  /// The plan and camera of a run with the file.
  json info(std::vector<std::string> flags = {}) const {
    flags.insert(flags.begin(), {"info", path("in.exr"), "--json", "--config", path("o.toml")});
    const Finished done = run_tool(flags);
    EXPECT_EQ(done.code, 0) << done.err;
    return parse_json(done.out);
  }
  TempDir dir_;
};

/// Issue 4: all of these were ignored, and the run went on with defaults.
TEST_F(Config, WhatIsNoOptionOrNoTomlIsRefusedWithItsLine) {
  const std::vector<std::tuple<std::string, int, std::string>> bad = {
      {"radus = 3\n", 1, "'radus' is no option"},
      {"slices = 3\n\nRadius = 3\n", 3, "'Radius' is no option"},
      {"o = \"a.exr\"\n", 1, "'o' is no option"},
      {"INPUT = \"a.exr\"\n", 1, "'INPUT' is no option"},
      {"slices = 3\nradius 3\n", 2, "not TOML"},
      {"this is not toml", 1, "not TOML"},
      {"[light]\nenv = \"1\"\n", 1, "light: is a table"},
      {"env.rotate = 3\n", 1, "env: is a table"},
      {"\xff\xfer\0a\0", 1, "not TOML"},
      {"slices = 3\nslices = 4\n", 2, "not TOML"},
      {"config = \"a.toml\"\n", 1, "on the command line only"},
      {"help = true\n", 1, "on the command line only"},
      {"list-methods = true\n", 1, "on the command line only"},
      {"json = true\n", 1, "is an option of ssdo info"},
      {"truth = \"a.exr:AO\"\n", 1, "is an option of ssdo bench"},
      {"fail-above = 1\n", 1, "is an option of ssdo compare"},
  };
  for (const auto& [text, line, says] : bad) {
    write(text);
    const Finished done = dry_run();
    EXPECT_EQ(done.code, 2) << text;
    EXPECT_THAT(done.error_line(), HasSubstr("o.toml:" + std::to_string(line) + ": ")) << text;
    EXPECT_THAT(done.error_line(), HasSubstr(says)) << text;
  }
  const Finished image =
      run_tool({path("in.exr"), "-o", path("out.exr"), "--config", path("in.exr")});
  EXPECT_EQ(image.code, 2);
  EXPECT_THAT(image.error_line(), HasSubstr("in.exr:1: not TOML"));
  EXPECT_EQ(run_tool({path("in.exr"), "--dry-run", "--config", dir_.path()}).code, 2) << "a folder";
}

/// Issue 4: a value is held to the same rules as on the command line.
TEST_F(Config, AValueThatTheOptionDoesNotTakeIsRefusedWithItsLine) {
  for (const std::string line : {"slices = 900",          "slices = \"many\"",
                                 "slices = true",         "slices = [1, 2]",
                                 "bounces = 2.5",         "seed = -1",
                                 "radius = \"wide\"",     "radius = -1",
                                 "radius = nan",          "thickness = []",
                                 "overwrite = 1",         "overwrite = \"true\"",
                                 "env = [1, 1, 1]",       "frames = \"1-\"",
                                 "frames = 2026-01-01",   "part = \"\"",
                                 "aov = \"position\"",    "aov = [[\"position=P\"]]",
                                 "save = [\"ao\"]",       "method = \"magic\"",
                                 "filter = \"magic\"",    "compression = \"zip:0\"",
                                 "depth-kind = \"near\"", "motion-scale = \"1\"",
                                 "quality = \"best\"",    "bits = 10",
                                 "mem-limit = 8",         "mem-limit = \"8\""}) {
    write("\n" + line + "\n");
    const Finished done = dry_run();
    EXPECT_EQ(done.code, 2) << line;
    EXPECT_THAT(done.error_line(), HasSubstr("o.toml:2: ")) << line;
  }
}

/// Issue 4: also behind a byte-order mark, in any type that TOML has for it.
TEST_F(Config, EveryKindOfValueIsTaken) {
  write(
      "\xef\xbb\xbfslices = 3\r\n# by a Windows editor\r\nradius = 0.25\nbounces = \"0\"\n"
      "products = [\"ao\", \"bent\"]\nfilter = 'source'\ntemporal = false\nthickness = inf\n"
      "mem-limit = \"1G\"\n");
  const json plan = info()["plan"];
  EXPECT_EQ(plan["slices"], 3);
  EXPECT_NEAR(plan["radius"].get<double>(), 0.25, 1e-6);
  EXPECT_EQ(plan["products"], json({"ao", "bent"}));
  EXPECT_EQ(plan["filter"], "geometry") << "that of the source of bitmask";
  EXPECT_THAT(plan["reasons"].dump(), HasSubstr("thickness inf: as given"));

  write(
      "output = [\"a.exr\", \"b.png\"]\nsave = [\"ao=c.exr\", \"bent=d.exr\"]\noverwrite = true\n");
  EXPECT_EQ(run_tool({path("in.exr"), "--config", path("o.toml")}, {.folder = dir_.path()}).code,
            0);
  EXPECT_THAT(listing(dir_.path()),
              testing::ElementsAre("a.exr", "b.png", "c.exr", "d.exr", "in.exr", "o.toml"));
}

TEST_F(Config, TheCommandLineWinsOverWhatItExcludesToo) {
  write("slices = 3\nfov = 20\nverbose = true\nproducts = \"ao\"\n");
  EXPECT_EQ(info({"--slices", "5"})["plan"]["slices"], 5);
  EXPECT_EQ(info({"--products", "bent"})["plan"]["products"], json({"bent"}));
  EXPECT_EQ(dry_run({"--ortho", "4"}).code, 0) << "-q excludes verbose, --ortho fov";
  write("fov = 20\northo = 4\n");
  const Finished both = dry_run();
  EXPECT_EQ(both.code, 2);
  EXPECT_THAT(both.error_line(), HasSubstr("o.toml:2: ortho: excludes --fov"));
}

/// The ladder of a bench chooses settings, wherever they are named.
TEST_F(Config, ABenchRefusesTheSettingsOfAFileToo) {
  write("quality = \"final\"\n");
  const Finished done = run_tool({"bench", path("in.exr"), "--config", path("o.toml")});
  EXPECT_EQ(done.code, 2);
  EXPECT_THAT(done.error_line(), HasSubstr("bench takes no --quality"));
}

}  // namespace
}  // namespace ssdo::test::config_test
