// SPDX-License-Identifier: Apache-2.0
//
// Frames of a sequence that are read and written while another one is estimated.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::overlap_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

/// Frames 1 to 5, of which the third has nine times as many pixels.
class Overlap : public testing::Test {
 protected:
  Overlap() {
    for (int frame = 1; frame <= 5; ++frame) {
      const int width = frame == 3 ? 192 : 64 + frame;
      const Window window{0, 0, width, width * 3 / 4};
      write_frame(path("in", frame), frame_of(small_picture(window, window)));
    }
  }
  std::string path(const std::string& name, int frame) const {
    return dir_ / (name + "." + std::to_string(frame) + ".exr");
  }
  Finished run(const std::string& out, std::vector<std::string> flags,
               const Surroundings& around = {}) const {
    flags.insert(flags.begin(), {dir_ / "in.@.exr", "-o", dir_ / (out + ".@.exr")});
    return run_tool(flags, around);
  }
  /// Has the output of the third frame fail, as on a disk that is full.
  Finished run_with_failure(const std::string& out, std::vector<std::string> flags) const {
    const auto size = [&](int frame) { return fs::file_size(path("whole", frame)); };
    flags.insert(flags.end(), {"--threads", "2"});
    return run(out, flags, {.file_size = (size(3) + size(5)) / 2});
  }
  std::vector<std::string> outputs_of(const std::string& out) const {
    std::vector<std::string> found;
    for (const std::string& name : listing(dir_.path())) {
      if (name.find(out + ".") != name.npos) found.push_back(name);
    }
    std::sort(found.begin(), found.end());
    return found;
  }
  TempDir dir_;
};

/// The numbers of the frames that lines are about.
std::vector<int> frames_of_lines(const std::string& text) {
  static const std::regex number(R"((in|out)\.(\d)\.exr)");
  std::vector<int> frames;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch found;
    const bool counts = line.find("the size changes") == line.npos;  // as it does in this shot
    if (counts && std::regex_search(line, found, number)) frames.push_back(std::stoi(found[2]));
  }
  return frames;
}

TEST_F(Overlap, FilesAreThoseOfRunsOfOneFrame) {
  ASSERT_EQ(run("all", {"--threads", "3"}).code, 0);
  for (int frame = 1; frame <= 5; ++frame) {
    ASSERT_EQ(run("one", {"--threads", "1", "--frames", std::to_string(frame)}).code, 0);
    EXPECT_TRUE(read_file(path("all", frame)) == read_file(path("one", frame))) << frame;
  }
}

/// A frame is described before it is estimated, and has a warning after it was written.
TEST_F(Overlap, LinesComeInTheOrderOfTheFrames) {
  for (const std::string threads : {"1", "2"}) {
    const Finished done =
        run("out", {"--env", "1e9,1e9,1e9", "-v", "--overwrite", "--threads", threads});
    EXPECT_EQ(done.code, 0);
    EXPECT_THAT(frames_of_lines(done.err), ElementsAre(1, 1, 2, 2, 3, 3, 4, 4, 5, 5)) << done.err;
  }
}

TEST_F(Overlap, AFrameThatCannotBeWrittenFailsInItsPlace) {
  ASSERT_EQ(run("whole", {"--threads", "2"}).code, 0);
  const Finished went_on =
      run_with_failure("out", {"--on-error", "continue", "-v", "--stats", dir_ / "stats.json"});
  EXPECT_EQ(went_on.code, 5);
  EXPECT_THAT(went_on.err, HasSubstr("out.3.exr: cannot be written"));
  EXPECT_THAT(frames_of_lines(went_on.err), ElementsAre(1, 2, 3, 3, 4, 5)) << went_on.err;
  EXPECT_THAT(outputs_of("out"), ElementsAre("out.1.exr", "out.2.exr", "out.4.exr", "out.5.exr"));
  std::vector<int> made;
  for (const json& frame : parse_json(read_file(dir_ / "stats.json")))
    made.push_back(frame["frame"]);
  EXPECT_THAT(made, ElementsAre(1, 2, 4, 5));
  for (const int frame : {1, 2, 4, 5})
    EXPECT_TRUE(read_file(path("out", frame)) == read_file(path("whole", frame))) << frame;
}

TEST_F(Overlap, AFrameThatCannotBeWrittenStopsTheRun) {
  ASSERT_EQ(run("whole", {"--threads", "2"}).code, 0);
  const Finished stopped = run_with_failure("out", {"-v"});
  EXPECT_EQ(stopped.code, 5);
  EXPECT_THAT(frames_of_lines(stopped.err), ElementsAre(1, 2, 3, 3)) << stopped.err;
  EXPECT_THAT(outputs_of("out"), ElementsAre("out.1.exr", "out.2.exr"));
  // A frame before one that cannot be read is written all the same.
  fs::resize_file(path("in", 3), 100);
  EXPECT_EQ(run("cut", {"--threads", "2"}).code, 3);
  EXPECT_THAT(outputs_of("cut"), ElementsAre("cut.1.exr", "cut.2.exr"));
}

TEST_F(Overlap, ProgressNeverGoesBack) {
  const Finished told = run("out", {"--progress", "openjd", "--threads", "2"});
  static const std::regex number(R"(openjd_progress: (\d+)\n)");
  std::vector<int> percents;
  for (std::sregex_iterator at(told.out.begin(), told.out.end(), number), end; at != end; ++at)
    percents.push_back(std::stoi((*at)[1]));
  ASSERT_GE(percents.size(), 5u);
  EXPECT_EQ(percents.back(), 100);
  EXPECT_TRUE(std::adjacent_find(percents.begin(), percents.end(), std::greater_equal<int>()) ==
              percents.end())
      << told.out;
}

TEST_F(Overlap, SkippedFramesDoNotDisturbTheOthers) {
  ASSERT_EQ(run("whole", {}).code, 0);
  for (const int frame : {1, 3}) fs::copy_file(path("whole", frame), path("out", frame));
  const Finished done = run("out", {"--skip-existing", "--threads", "2", "-v"});
  EXPECT_EQ(done.code, 0);
  for (int frame = 1; frame <= 5; ++frame)
    EXPECT_TRUE(read_file(path("out", frame)) == read_file(path("whole", frame))) << frame;
  const auto skipped = [&](int frame) {
    return done.err.find("in." + std::to_string(frame) + ".exr: skipped");
  };
  EXPECT_LT(skipped(1), skipped(3));
  EXPECT_EQ(skipped(2), done.err.npos);
}

/// Two frames: the one that is estimated, and the one that is written or read.
TEST(OverlapMemory, DoesNotGrowWithTheSequence) {
  const TempDir dir;
  const Window window{0, 0, 640, 480};
  write_frame(dir / "in.1.exr", frame_of(small_picture(window, window)));
  for (int frame = 2; frame <= 8; ++frame)
    fs::create_hard_link(dir / "in.1.exr", dir / ("in." + std::to_string(frame) + ".exr"));
  const auto peak = [&](const std::string& frames) {
    const std::string log = dir / "stats.json";
    EXPECT_EQ(run_tool({dir / "in.@.exr", "-o", dir / "out.@.exr", "--frames", frames, "--threads",
                        "2", "--overwrite", "--quality", "draft", "--stats", log})
                  .code,
              0);
    return parse_json(read_file(log)).back()["peak_rss_bytes"].get<double>();
  };
  // Holes between planes of two frames are found within the first few.
  EXPECT_LT(peak("1-8"), 1.2 * peak("1-5"));
}

}  // namespace
}  // namespace ssdo::test::overlap_test
