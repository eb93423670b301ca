// SPDX-License-Identifier: Apache-2.0
//
// A chunk of frames among many machines: what fails, what is done again, how many threads.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::farm_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;

class Farm : public testing::Test {
 protected:
  Farm() {
    for (const int frame : {1, 2, 3}) write_frame(in(frame), frame_of(small_picture()));
  }
  std::string path(const std::string& name) const { return dir_ / name; }
  std::string in(int frame) const { return path("in.000" + std::to_string(frame) + ".exr"); }
  std::string out(int frame) const { return path("out.000" + std::to_string(frame) + ".exr"); }
  Finished run(std::vector<std::string> flags, const Surroundings& around = {}) const {
    flags.insert(flags.begin(), {path("in.####.exr"), "-o", path("out.####.exr")});
    return run_tool(flags, around);
  }
  TempDir dir_;
};

TEST_F(Farm, TheCodeIsThatOfTheFirstFrameThatFailed) {
  FramePart bare = frame_of(small_picture());
  std::erase_if(bare.channels,
                [](const auto& c) { return c.first.find("DiffCol") == c.first.npos; });
  write_frame(in(1), bare);                          // 4: no position
  fs::resize_file(in(3), fs::file_size(in(3)) / 2);  // 3: cut short
  std::ofstream(out(2)) << "in the way";             // 5
  const Finished all = run({"--on-error", "continue"});
  EXPECT_EQ(all.code, 4);
  for (const int frame : {1, 2, 3}) EXPECT_THAT(all.err, HasSubstr("000" + std::to_string(frame)));
  EXPECT_EQ(std::count(all.err.begin(), all.err.end(), '\n'), 3) << all.err;
  EXPECT_EQ(run({"--on-error", "continue", "--frames", "3-1"}).code, 3);
  EXPECT_EQ(run({"--on-error", "continue", "--frames", "2,1,3"}).code, 5);
  const Finished stopped = run({"--frames", "2-3"});
  EXPECT_EQ(stopped.code, 5);
  EXPECT_THAT(stopped.error_line(), HasSubstr("out.0002.exr"));
  EXPECT_EQ(read_file(out(2)), "in the way");
  EXPECT_FALSE(fs::exists(out(1)) || fs::exists(out(3)));
}

TEST_F(Farm, APathThatAppearsTwiceStandsForOneFrameEach) {
  const Finished done = run_tool(
      {path("in.%04d.exr"), "-o", path("f_@@@/relit.#.exr"), "--create-dirs", "--frames", "3,1"});
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_TRUE(fs::exists(path("f_001/relit.0001.exr")));
  EXPECT_TRUE(fs::exists(path("f_003/relit.0003.exr")));
  EXPECT_FALSE(fs::exists(path("f_002")));
}

TEST_F(Farm, OneFrameMayGoToAFileWithoutAPattern) {
  EXPECT_EQ(run_tool({path("in.####.exr"), "-o", path("one.exr"), "--frames", "2"}).code, 0);
  EXPECT_TRUE(fs::exists(path("one.exr")));
}

TEST_F(Farm, AFrameIsDoneOnlyWithAllItsOutputs) {
  const std::vector<std::string> pictures = {"-o", path("out.####.png"), "--frames", "1-2"};
  EXPECT_EQ(run(pictures).code, 0);
  const std::string whole = read_file(path("out.0001.png"));
  ASSERT_GT(whole.size(), 500u);
  fs::resize_file(path("out.0001.png"), whole.size() / 2);
  fs::remove(path("out.0002.png"));
  std::vector<std::string> again = pictures;
  again.push_back("--skip-existing");
  EXPECT_EQ(run(again).code, 0);
  EXPECT_TRUE(read_file(path("out.0001.png")) == whole) << "cut short, so made again";
  EXPECT_TRUE(fs::exists(path("out.0002.png")));

  const Finished third = run({"-o", path("out.####.png"), "--frames", "1-2", "--skip-existing",
                              "--progress", "openjd", "--stats", path("stats.json"), "-v"});
  EXPECT_EQ(third.code, 0);
  EXPECT_THAT(third.out, testing::EndsWith("openjd_progress: 100\n"));
  EXPECT_THAT(third.err, HasSubstr("skipped"));
  EXPECT_EQ(parse_json(read_file(path("stats.json"))).size(), 0u) << "nothing was made";
}

TEST_F(Farm, SkippedFramesNeedNoInput) {
  EXPECT_EQ(run({"--frames", "1-2"}).code, 0);
  fs::remove(in(1));
  EXPECT_EQ(run({"--frames", "1-2", "--skip-existing"}).code, 0);
}

TEST_F(Farm, StatisticsOfAChunkThatBreaksOffHoldWhatWasDone) {
  fs::remove(in(2));
  EXPECT_EQ(run({"--frames", "1-3", "--stats", path("stats.json")}).code, 3);
  const json stats = parse_json(read_file(path("stats.json")));
  ASSERT_EQ(stats.size(), 1u);
  EXPECT_EQ(stats[0]["frame"], 1);
}

TEST_F(Farm, SeveralOutputsOfAFrameAreAllInItsStatistics) {
  EXPECT_EQ(run({"-o", path("out.####.png"), "--frames", "2", "--stats", path("stats.json"),
                 "--slices", "3", "--steps", "4", "--bounces", "2"})
                .code,
            0);
  const json frame = parse_json(read_file(path("stats.json"))).at(0);
  EXPECT_EQ(frame["output"], json({out(2), path("out.0002.png")}));
  EXPECT_EQ(frame["samples_per_pixel"], 2 * 3 * 4);
  EXPECT_THAT(frame["isa"].get<std::string>(), testing::AnyOf("avx512", "avx2", "neon", "scalar"));
  EXPECT_EQ(frame["bounces"], 2);
  EXPECT_EQ(frame["plan"]["slices"], 3);
  EXPECT_EQ(frame["plan"]["radius"], "inf");
  EXPECT_EQ(frame["plan"]["products"], json({"ao", "direct", "bounce", "composite"}));
  EXPECT_GT(frame["peak_rss_bytes"].get<double>(), 1e6);
  const json& ms = frame["stages_ms"];
  double sum = 0;
  for (const char* stage : {"read", "known", "prepare", "estimate", "filter", "compose", "write"})
    sum += ms[stage].get<double>();
  EXPECT_NEAR(ms["total"].get<double>(), sum, 1e-6 * sum);
  EXPECT_GT(sum, 0);
}

/// Issue 20: 99999 threads ended in "Resource temporarily unavailable".
TEST_F(Farm, AUsersNumberOfThreadsHasARange) {
  for (const std::string value : {"many", "0", "-2", "2.5", "4 ", "4097", "99999", "1e99"}) {
    const Finished done = run({"--frames", "1"}, {.variables = {{"SSDO_THREADS", value}}});
    EXPECT_EQ(done.code, 2) << value;
    EXPECT_THAT(done.error_line(), HasSubstr("$SSDO_THREADS is '" + value + "'"));
    EXPECT_THAT(done.error_line(), HasSubstr("1 to 4096"));
  }
  EXPECT_EQ(run({"--frames", "1", "--overwrite", "--threads", "1"},
                {.variables = {{"SSDO_THREADS", "many"}}})
                .code,
            0)
      << "the flag wins";
}

/// Who submits a job does not set the scheduler's variables: nonsense there fails no frame, nor
/// does OpenImageIO, which reads CUE_THREADS itself, start that many threads.
TEST_F(Farm, NonsenseOfASchedulerIsPassedOver) {
  const auto threads = [&](const std::map<std::string, std::string>& variables) {
    const Finished done = run({"--frames", "1", "--overwrite", "--stats", path("stats.json")},
                              {.variables = variables});
    EXPECT_EQ(done.code, 0) << done.err;
    return parse_json(read_file(path("stats.json"))).at(0).at("threads").get<int>();
  };
  for (const std::string value : {"", "many", "0", "-2", "2.5", "99999", "1e99"}) {
    EXPECT_EQ(threads({{"CUE_THREADS", value}, {"SLURM_CPUS_PER_TASK", "3"}}), 3) << value;
    EXPECT_GE(threads({{"SLURM_CPUS_PER_TASK", value}}), 1) << value;
  }
}

TEST_F(Farm, InfoOfASequenceIsAnArray) {
  const Finished done = run_tool({"info", path("in.####.exr"), "--frames", "1-2", "--json"});
  EXPECT_EQ(done.code, 0);
  const json frames = parse_json(done.out);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0]["file"], in(1));
  EXPECT_EQ(frames[1]["file"], in(2));
}

}  // namespace
}  // namespace ssdo::test::farm_test
