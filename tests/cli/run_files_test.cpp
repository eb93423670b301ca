// SPDX-License-Identifier: Apache-2.0
//
// No file of a run is written over another one of it: issue 12.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "support/bench_frame.h"
#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test::run_files_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class RunFiles : public testing::Test {
 protected:
  RunFiles() { write_frame(path("in.exr"), frame_of(small_picture())); }
  std::string path(const std::string& name) const { return dir_ / name; }
  /// In the folder of the files, which keep their bytes.
  void expect_refused(const std::vector<std::string>& arguments, int code, const std::string& says,
                      const Surroundings& around = {}) const {
    std::map<std::string, std::string> before;
    for (const std::string& name : listing(dir_.path())) before[name] = read_file(path(name));
    Surroundings here = around;
    here.folder = dir_.path();
    const Finished done = run_tool(arguments, here);
    EXPECT_EQ(done.code, code) << testing::PrintToString(arguments) << done.err;
    EXPECT_THAT(done.error_line(), HasSubstr(says)) << testing::PrintToString(arguments);
    for (const std::string& name : listing(dir_.path()))
      EXPECT_TRUE(before.contains(name) && before[name] == read_file(path(name))) << name;
  }
  TempDir dir_;
};

TEST_F(RunFiles, NoOutputIsAnotherOutput) {
  fs::create_directory_symlink("new", path("later"));  // leads to a folder that does not exist yet
  fs::create_symlink("x.exr", path("link.exr"));
  const std::vector<std::vector<std::string>> outputs = {
      {"-o", "x.exr", "--stats", "x.exr"},
      {"-o", "x.exr", "--save", "ao=./x.exr"},
      {"-o", "x.exr", "--save", "ao=" + path("x.exr")},
      {"-o", "x.exr", "--save", "ao=link.exr"},
      {"-o", "x.exr", "-o", "new/../x.exr", "--create-dirs"},
      {"-o", "new/x.exr", "-o", "./new/./x.exr", "--create-dirs"},
      {"-o", "new/x.exr", "-o", "later/x.exr", "--create-dirs"},
      {"--save", "ao=a.exr", "--save", "direct=./a.exr"},
      {"--save", "ao=a.exr", "--stats", "./a.exr"},
  };
  for (const bool dry : {false, true}) {
    for (std::vector<std::string> arguments : outputs) {
      arguments.insert(arguments.begin(), {"in.exr", "--overwrite"});
      if (dry) arguments.push_back("--dry-run");
      expect_refused(arguments, 2, "named twice as an output");
    }
  }
}

TEST_F(RunFiles, NoOutputIsAnInput) {
  std::ofstream(path("o.toml")) << "slices = 3\n";
  std::ofstream(path("c.json")) << R"({"hfov_deg": 40})";
  fs::copy_file(data("color/config.ocio"), path("c.ocio"));
  fs::copy_file(path("in.exr"), path("lends.exr"));
  fs::copy_file(data("environments/sky.exr"), path("sky.exr"));
  fs::create_hard_link(path("in.exr"), path("hard.json"));
  fs::create_symlink("in.exr", path("link.json"));
  const std::vector<std::pair<std::vector<std::string>, std::string>> inputs = {
      {{"--stats", "in.exr"}, "INPUT"},
      {{"--stats", "./hard.json"}, "INPUT"},
      {{"--stats", "link.json"}, "INPUT"},
      {{"--config", "o.toml", "--stats", "o.toml"}, "--config"},
      {{"--camera", "c.json", "--stats", "./c.json"}, "--camera"},
      {{"--ocio", "c.ocio", "--stats", path("c.ocio")}, "--ocio"},
      {{"--aov", "normal=lends.exr:ViewLayer.Normal", "-o", "lends.exr"}, "--aov"},
      {{"--also", "lends.exr", "-o", "lends.exr"}, "--also"},
      {{"--env", "sky.exr", "--stats", "sky.exr"}, "--env"},
  };
  for (const auto& [more, option] : inputs) {
    std::vector<std::string> arguments = {"in.exr", "-o", "out.exr", "--overwrite"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_refused(arguments, 5, "is an input (" + option + ")");
  }
  expect_refused({"in.exr", "-o", "out.exr", "--stats", "c.ocio"}, 5, "is an input ($OCIO)",
                 {.variables = {{"OCIO", "c.ocio"}}});
}

/// Frames of one run are one table: a frame is never the output of another.
TEST_F(RunFiles, NoFrameIsWrittenOverThatOfAnother) {
  const FramePart frame = frame_of(small_picture());
  for (const char* name : {"a.0001.exr", "a.0002.exr"}) write_frame(path(name), frame);
  // Frame 1 goes to the file that frame 10001 is read from, be it there already or not.
  const std::vector<std::string> onto = {"a.####.exr", "-o", "a.1####.exr", "--overwrite",
                                         "--frames"};
  std::vector<std::string> arguments = onto;
  arguments.push_back("1,10001");
  expect_refused(arguments, 5, "a.10001.exr: is an input (INPUT)");
  // The second frame is held: its file of yesterday is a link to the first one's.
  fs::create_symlink("out.0001.exr", path("out.0002.exr"));
  expect_refused({"a.####.exr", "-o", "out.####.exr", "--overwrite"}, 2, "named twice");
  expect_refused({"a.####.exr", "-o", "b.####.exr", "--save", "ao=b.%04d.exr"}, 2, "named twice");
  arguments = onto;
  arguments.push_back("1-2");
  EXPECT_EQ(run_tool(arguments, {.folder = dir_.path()}).code, 0) << "no frame is touched";
}

/// Hard links that a deduplicated disk has made are files of their own: a rename parts them.
TEST_F(RunFiles, OutputsThatAreHardLinksAreTwoFiles) {
  std::ofstream(path("a.exr")) << "black";
  fs::create_hard_link(path("a.exr"), path("b.exr"));
  EXPECT_EQ(run_tool({path("in.exr"), "--save", "ao=" + path("a.exr"), "--save",
                      "direct=" + path("b.exr"), "--overwrite"})
                .code,
            0);
  EXPECT_THAT(channel_names(path("a.exr")), testing::ElementsAre("ao.Y"));
  EXPECT_EQ(channel_names(path("b.exr")).size(), 3u);
}

TEST_F(RunFiles, NoStatisticsAreLostWhereNothingIsMade) {
  std::ofstream(path("s.json")) << "[1]";
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"info", path("in.exr"), "--stats", path("s.json")},
        {path("in.exr"), "--dry-run", "--stats", path("s.json")}}) {
    EXPECT_EQ(run_tool(arguments).code, 0);
    EXPECT_EQ(read_file(path("s.json")), "[1]");
  }
}

TEST_F(RunFiles, ADifferenceReplacesNeitherPictureNorMask) {
  fs::copy_file(path("in.exr"), path("mask.exr"));
  for (const char* out : {"in.exr", "./mask.exr"}) {
    expect_refused({"compare", "in.exr:ViewLayer.Normal", "in.exr:ViewLayer.Normal", "--mask",
                    "mask.exr:ViewLayer.Normal", "--diff", out, "--overwrite"},
                   5, "is an input");
  }
}

TEST_F(RunFiles, AReportReplacesNothingThatABenchReads) {
  std::ofstream(path("c.json")) << R"({"hfov_deg": 40})";
  expect_refused({"bench", "in.exr", "--camera", "c.json", "--report", "./c.json", "--overwrite"},
                 5, "is an input (--camera)");
  expect_refused({"bench", "in.exr", "--report", "r.json", "--report", "./r.json"}, 2,
                 "named twice");
}

/// Issue 20: a dry run passed where the real one is refused before its work.
TEST_F(RunFiles, ADryRunIsRefusedLikeTheRealOne) {
  std::ofstream(path("there.exr")) << "yesterday's work";
  const std::vector<std::pair<std::vector<std::string>, int>> refused = {
      {{"-o", "gone/out.exr"}, 5},
      {{"-o", "there.exr"}, 5},
      {{"-o", "in.exr/out.exr", "--create-dirs"}, 5},
      {{"-o", "in.exr", "--overwrite"}, 5},
      {{"-o", "out.gif"}, 2},
      {{"-o", "out.exr", "--stats", "gone/s.json"}, 5},
      {{"-o", "out.png", "--view", "Sepia"}, 2},
      {{"-o", "out.png", "--ocio", "in.exr"}, 3},
      {{"-o", "out.exr", "--products", "glow"}, 2},
  };
  for (const auto& [more, code] : refused) {
    std::vector<std::string> arguments = {"in.exr"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_refused(arguments, code, "");
    arguments.push_back("--dry-run");
    expect_refused(arguments, code, "");
  }
  EXPECT_EQ(
      run_tool({path("in.exr"), "-o", path("new/out.exr"), "--create-dirs", "--dry-run"}).code, 0);
  EXPECT_FALSE(fs::exists(path("new")));
}

}  // namespace
}  // namespace ssdo::test::run_files_test
