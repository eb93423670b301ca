// SPDX-License-Identifier: Apache-2.0
//
// Outputs are whole or not at all, and nothing that exists is lost.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test::files_test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class Files : public testing::Test {
 protected:
  Files() { write_frame(in(), frame_of(small_picture())); }
  fs::path in() const { return dir_ / "in.exr"; }
  std::string path(const std::string& name) const { return dir_ / name; }
  TempDir dir_;
};

TEST_F(Files, AnOutputThatExistsIsKept) {
  std::ofstream(path("out.exr")) << "yesterday's work";
  const Finished kept = run_tool({in(), "-o", path("new.exr"), "-o", path("out.exr")});
  EXPECT_EQ(kept.code, 5);
  EXPECT_THAT(kept.error_line(), HasSubstr("--overwrite"));
  EXPECT_TRUE(read_file(path("out.exr")) == "yesterday's work");
  EXPECT_FALSE(fs::exists(path("new.exr"))) << "all outputs or none";
  EXPECT_EQ(run_tool({in(), "-o", path("out.exr"), "--overwrite"}).code, 0);
  EXPECT_THAT(listing(dir_.path()), ElementsAre("in.exr", "out.exr"));
}

TEST_F(Files, FoldersAreMadeOnRequest) {
  const Finished refused = run_tool({in(), "-o", path("a/b/out.exr")});
  EXPECT_EQ(refused.code, 5);
  EXPECT_THAT(refused.error_line(), HasSubstr("--create-dirs"));
  EXPECT_EQ(run_tool({in(), "-o", path("a/b/out.exr"), "--create-dirs"}).code, 0);
  EXPECT_TRUE(fs::exists(path("a/b/out.exr")));
  fs::create_directory(path("folder.exr"));
  EXPECT_EQ(run_tool({in(), "-o", path("folder.exr"), "--overwrite"}).code, 5);
}

TEST_F(Files, TheInputIsNeverAnOutput) {
  const std::string before = read_file(in());
  fs::create_symlink(in(), path("link.exr"));
  fs::create_hard_link(in(), path("hard.exr"));
  for (const std::string& name : {std::string(in()), path("link.exr"), path("hard.exr"),
                                  path("./../") + dir_.path().filename().string() + "/in.exr"}) {
    const Finished done = run_tool({in(), "-o", name, "--overwrite"});
    EXPECT_EQ(done.code, 5) << name;
    EXPECT_THAT(done.error_line(), HasSubstr("is an input"));
  }
  EXPECT_EQ(run_tool({"in.exr", "-o", "in.exr", "--overwrite"}, {.folder = dir_.path()}).code, 5);
  // Nor is a file that lends a layer, the environment or the camera.
  fs::copy_file(in(), path("other.exr"));
  const std::string aov = "normal=" + path("other.exr") + ":ViewLayer.Normal";
  EXPECT_EQ(run_tool({in(), "--aov", aov, "-o", path("other.exr"), "--overwrite"}).code, 5);
  fs::copy_file(data("environments/sky.exr"), path("sky.exr"));
  EXPECT_EQ(run_tool({in(), "--env", path("sky.exr"), "-o", path("sky.exr"), "--overwrite"}).code,
            5);
  EXPECT_EQ(run_tool({in(), "-o", path("out.exr"), "--stats", in()}).code, 5);
  EXPECT_TRUE(read_file(in()) == before);
  EXPECT_TRUE(read_file(path("other.exr")) == before);
}

TEST_F(Files, AFullDiskLosesNothing) {
  std::ofstream(path("out.exr")) << "yesterday's work";
  for (const rlim_t limit : {0, 1, 100, 2000, 4096}) {
    const Finished done = run_tool(
        {in(), "-o", path("out.exr"), "-o", path("out.png"), "--overwrite"}, {.file_size = limit});
    EXPECT_EQ(done.code, 5) << limit;
    EXPECT_THAT(done.error_line(), HasSubstr("out.")) << limit;
    EXPECT_TRUE(read_file(path("out.exr")) == "yesterday's work");
    EXPECT_THAT(listing(dir_.path()), ElementsAre("in.exr", "out.exr")) << limit;
  }
}

TEST_F(Files, ASignalLeavesNothingBehind) {
  for (const auto& [signal, code] : {std::pair{SIGTERM, 143}, {SIGINT, 130}}) {
    std::ofstream(path("out.exr")) << "yesterday's work";
    // A large picture, so that there is time between the temporary and the rename.
    const auto temporary_exists = [&] {
      const auto names = listing(dir_.path());
      return std::any_of(names.begin(), names.end(),
                         [](const std::string& n) { return n.find(".tmp") != std::string::npos; });
    };
    const Finished done =
        run_tool({data("still_life.exr"), "-o", path("out.exr"), "-o", path("a.png"), "-o",
                  path("b.png"), "-o", path("c.tif"), "--overwrite", "--bits", "16"},
                 {.kill_with = signal, .kill_when = temporary_exists});
    EXPECT_EQ(done.code, code);
    EXPECT_TRUE(read_file(path("out.exr")) == "yesterday's work");
    EXPECT_THAT(listing(dir_.path()), ElementsAre("in.exr", "out.exr"));
  }
  // In the midst of the estimate.
  const auto at_once = [n = 0]() mutable { return ++n > 300; };
  const Finished done = run_tool(
      {data("still_life.exr"), "-o", path("new.exr"), "--method", "ssdo", "--set", "samples=1024"},
      {.kill_with = SIGTERM, .kill_when = at_once});
  EXPECT_EQ(done.code, 143);
  EXPECT_FALSE(fs::exists(path("new.exr")));
}

}  // namespace
}  // namespace ssdo::test::files_test
