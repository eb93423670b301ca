// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/analytic_scene.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::batch_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

/// A shot of frames 1, 2, 4 and 5: the third is missing, as happens.
class Shot : public testing::Test {
 protected:
  Shot() {
    for (const int frame : {1, 2, 4, 5}) write_frame(file("in", frame), frame_of(small_picture()));
  }
  std::string file(const std::string& name, int frame) const {
    return dir_ / (name + ".000" + std::to_string(frame) + ".exr");
  }
  Finished run(std::vector<std::string> flags, const Surroundings& around = {}) const {
    flags.insert(flags.begin(), {dir_ / "in.####.exr", "-o", dir_ / "out.####.exr"});
    return run_tool(flags, around);
  }
  std::vector<int> done() const {
    std::vector<int> frames;
    for (int frame = 1; frame <= 6; ++frame) {
      if (fs::exists(file("out", frame))) frames.push_back(frame);
    }
    return frames;
  }
  json stats() const { return parse_json(read_file(dir_ / "stats.json")); }
  TempDir dir_;
};

TEST_F(Shot, WithoutARangeEveryFrameThatExistsIsDone) {
  EXPECT_EQ(run({}).code, 0);
  EXPECT_THAT(done(), ElementsAre(1, 2, 4, 5));
}

TEST_F(Shot, ARangeIsDoneInItsOrder) {
  EXPECT_EQ(run({"--frames", "5-1x4,2", "--stats", dir_ / "stats.json"}).code, 0);
  EXPECT_THAT(done(), ElementsAre(1, 2, 5));
  std::vector<int> order;
  for (const json& frame : stats()) order.push_back(frame["frame"]);
  EXPECT_THAT(order, ElementsAre(5, 1, 2));
}

TEST_F(Shot, TheFolderOfItsStatisticsIsMadeWhereThatOfItsImagesIs) {
  const std::string log = dir_ / "new/deep/stats.json";
  const Finished refused = run({"--frames", "1", "--stats", log});
  EXPECT_EQ(refused.code, 5);
  EXPECT_THAT(refused.error_line(), HasSubstr("give --create-dirs"));
  EXPECT_THAT(done(), ElementsAre()) << "found before any work";
  EXPECT_EQ(run({"--frames", "1", "--create-dirs", "--stats", log}).code, 0);
  EXPECT_EQ(parse_json(read_file(log)).size(), 1u);
}

TEST_F(Shot, AMissingFrameIsNamedAndStopsOrNot) {
  const Finished stopped = run({"--frames", "1-5"});
  EXPECT_EQ(stopped.code, 3);
  EXPECT_THAT(stopped.error_line(), HasSubstr("in.0003.exr: frame 3 of the range is missing"));
  EXPECT_THAT(done(), ElementsAre(1, 2));
  std::ofstream(file("in", 4)) << "no image";
  const Finished went_on = run(
      {"--frames", "1-5", "--overwrite", "--on-error", "continue", "--stats", dir_ / "stats.json"});
  EXPECT_EQ(went_on.code, 3) << "the first failure's";
  EXPECT_THAT(done(), ElementsAre(1, 2, 5));
  EXPECT_THAT(went_on.err, HasSubstr("in.0003.exr"));
  EXPECT_THAT(went_on.err, HasSubstr("in.0004.exr"));
  EXPECT_EQ(std::count(went_on.err.begin(), went_on.err.end(), '\n'), 2)
      << "one line for each: " << went_on.err;
  EXPECT_EQ(stats().size(), 3u);
}

TEST_F(Shot, FramesThatAreDoneAreSkippedUnlessBroken) {
  EXPECT_EQ(run({"--frames", "1,2"}).code, 0);
  const std::string first = read_file(file("out", 1)), second = read_file(file("out", 2));
  fs::last_write_time(file("out", 1), fs::file_time_type::min());
  const auto age = fs::last_write_time(file("out", 1));
  fs::resize_file(file("out", 2), second.size() - 500);
  EXPECT_EQ(run({"--frames", "1,2,4"}).code, 5) << "without the flag they are in the way";
  EXPECT_EQ(run({"--frames", "1,2,4", "--skip-existing"}).code, 0);
  EXPECT_EQ(fs::last_write_time(file("out", 1)), age) << "not written again";
  EXPECT_TRUE(read_file(file("out", 2)) == second) << "cut short, so made again";
  EXPECT_THAT(done(), ElementsAre(1, 2, 4));
}

/// Issue 12, number 14: a JPEG that was cut in half counted as readable.
TEST_F(Shot, PicturesThatAreCutShortAreMadeAnew) {
  for (const std::string kind : {"jpg", "png", "tif"}) {
    const std::string picture = dir_ / ("out." + kind);
    const std::vector<std::string> flags = {file("in", 1), "-o", picture, "--skip-existing"};
    ASSERT_EQ(run_tool(flags).code, 0);
    const std::string whole = read_file(picture);
    const auto written = fs::last_write_time(picture);
    ASSERT_EQ(run_tool(flags).code, 0);
    EXPECT_EQ(fs::last_write_time(picture), written) << kind << " is skipped";
    fs::resize_file(picture, whole.size() / 2);
    ASSERT_EQ(run_tool(flags).code, 0);
    EXPECT_TRUE(read_file(picture) == whole) << kind;
  }
}

/// A frame that shows one plane only stopped the sequence; its own frames tell the lens.
TEST_F(Shot, AFlatFrameTakesTheLensOfAFrameBeside) {
  const Window window{0, 0, 64, 48};
  const Camera camera = look_at(small_picture().camera, {0, -4, 3}, {0, 0, 0}, {0, 0, 1});
  const FramePart flat = frame_of(take_picture(plane({}, {0, 0, 1}), camera, window));
  write_frame(file("in", 3), flat);
  write_frame(dir_ / "flat.exr", flat);
  EXPECT_EQ(run_tool({dir_ / "flat.exr", "-o", dir_ / "flat_out.exr"}).code, 4) << "alone";
  const Finished whole = run({});
  EXPECT_EQ(whole.code, 0) << whole.err;
  const std::string first = read_file(file("out", 3));
  EXPECT_EQ(run({"--frames", "3", "--overwrite"}).code, 0);
  EXPECT_TRUE(read_file(file("out", 3)) == first) << "however the shot is cut";
  const Finished info = run_tool({"info", dir_ / "in.####.exr", "--frames", "3"});
  EXPECT_THAT(info.out, HasSubstr("fitted from P with the lens of " + file("in", 2)));
  EXPECT_THAT(whole.err, HasSubstr("in.0003.exr: warning: P does not tell the camera"));
}

/// Layers came and went in silence, and with them bounce and composite.
TEST_F(Shot, WhatChangesFromFrameToFrameIsSaidOnce) {
  FramePart part = frame_of(small_picture());
  for (const char* c : {"R", "G", "B"}) part.channels.erase("ViewLayer.DiffCol." + std::string(c));
  write_frame(file("in", 2), part);
  write_frame(file("in", 4), part);
  const auto lines_with = [](const Finished& done, const std::string& text) {
    std::vector<std::string> found;
    std::istringstream in(done.err);
    for (std::string line; std::getline(in, line);)
      if (line.find(text) != line.npos) found.push_back(line);
    return found;
  };
  const Finished done = run({"--dry-run"});
  EXPECT_EQ(done.code, 0);
  EXPECT_THAT(lines_with(done, "albedo is "),
              ElementsAre(HasSubstr("in.0002.exr: warning: albedo is gone: frame 1 has it in "
                                    "'ViewLayer.DiffCol', frame 2 has none"),
                          HasSubstr("in.0005.exr: warning: albedo is new: frame 4 has none")));
  EXPECT_THAT(lines_with(run({"--dry-run", "--frames", "2,4"}), "albedo is "), ElementsAre());
  const Window small{0, 0, 32, 24};
  write_frame(file("in", 5), frame_of(small_picture(small, small)));
  EXPECT_THAT(lines_with(run({"--dry-run"}), "the size changes"),
              ElementsAre(HasSubstr("frame 4 has 64 x 48 pixels, frame 5 32 x 24")));
}

/// Every frame repeated the warnings of the one before.
TEST_F(Shot, AWarningThatRepeatsIsSaidOnce) {
  FramePart part = frame_of(small_picture());
  for (const char* c : {"R", "G", "B"}) part.channels.erase("ViewLayer.DiffCol." + std::string(c));
  for (const int frame : {2, 4, 5}) write_frame(file("in", frame), part);
  const Finished done = run({"--radius", "1e-5", "--stats", dir_ / "stats.json"});
  EXPECT_EQ(done.code, 0);
  const std::string pattern = "ssdo: " + (dir_ / "in.####.exr").string();
  std::vector<std::string> lines;
  std::istringstream in(done.err);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  EXPECT_THAT(
      lines,
      ElementsAre(StartsWith("ssdo: " + file("in", 1) + ": warning: --radius 1e-05 is"),
                  HasSubstr("in.0002.exr: warning: albedo is gone"),
                  StartsWith("ssdo: " + file("in", 2) + ": warning: no layer for albedo"),
                  pattern + ": warning: albedo: 'ViewLayer.DiffCol' (float) in frame 1, none in "
                            "frames 2 to 5",
                  AllOf(StartsWith(pattern + ": warning: --radius 1e-05 is"),
                        EndsWith("is it in the unit of P?: frames 1 to 5")),
                  AllOf(StartsWith(pattern + ": warning: no layer for albedo"),
                        EndsWith(": frames 2 to 5"))));
  for (const json& frame : stats()) {
    const std::string all = frame["warnings"].dump();
    EXPECT_THAT(all, HasSubstr("--radius 1e-05")) << "each frame has its own here";
    EXPECT_EQ(all.find("albedo") == all.npos, frame["frame"] == 1);
  }
  const Finished alone = run({"--radius", "1e-5", "--frames", "4", "--overwrite"});
  EXPECT_EQ(std::count(alone.err.begin(), alone.err.end(), '\n'), 2) << alone.err;
}

TEST_F(Shot, ManyFramesDoNotGoToOneFile) {
  const Finished refused = run_tool({dir_ / "in.####.exr", "-o", dir_ / "out.exr"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_THAT(refused.error_line(), HasSubstr("pattern"));
  const Finished none = run_tool({dir_ / "other.####.exr", "-o", dir_ / "out.####.exr"});
  EXPECT_EQ(none.code, 3);
  EXPECT_EQ(run({"--frames", "1-"}).code, 2);
}

TEST_F(Shot, StatisticsHoldWhatTheContractSays) {
  EXPECT_EQ(
      run({"--frames", "4", "--stats", dir_ / "stats.json", "--threads", "2", "--mem-limit", "1G"})
          .code,
      0);
  const json frame = stats().at(0);
  for (const char* key : {"frame", "input", "output", "width", "height", "threads", "isa", "method",
                          "samples_per_pixel", "bounces", "stages_ms", "peak_rss_bytes",
                          "mem_limit_bytes", "pixels", "background_pixels", "bad_pixels", "plan"}) {
    EXPECT_TRUE(frame.contains(key)) << key;
  }
  for (const char* stage :
       {"read", "known", "prepare", "estimate", "filter", "compose", "write", "total"}) {
    EXPECT_GE(frame["stages_ms"].at(stage).get<double>(), 0) << stage;
  }
  EXPECT_EQ(frame["frame"], 4);
  EXPECT_EQ(frame["input"], file("in", 4));
  EXPECT_EQ(frame["output"], file("out", 4));
  EXPECT_EQ(frame["threads"], 2);
  EXPECT_EQ(frame["mem_limit_bytes"], 1 << 30);
  EXPECT_EQ(frame["width"], 64);
  EXPECT_EQ(frame["pixels"], 64 * 48);
}

TEST_F(Shot, SchedulersReadTheirOwnProgress) {
  for (const auto& [style, line] :
       {std::pair<std::string, std::string>{"tractor", "TR_PROGRESS 100%\n"},
        {"alfred", "ALF_PROGRESS 100%\n"},
        {"openjd", "openjd_progress: 100\n"}}) {
    const Finished told = run({"--overwrite", "--progress", style});
    EXPECT_EQ(told.code, 0);
    EXPECT_THAT(told.out, testing::EndsWith(line));
    EXPECT_GE(std::count(told.out.begin(), told.out.end(), '\n'), 4)
        << "a line for each frame at least";
    EXPECT_EQ(told.err, "");
  }
  const Finished silent = run({"--overwrite", "--progress", "auto"});
  EXPECT_EQ(silent.out + silent.err, "") << "no bar without a terminal";
}

TEST_F(Shot, ThreadsComeFromTheFlagThenTheSchedulerThenTheMachine) {
  const auto threads = [&](std::vector<std::string> flags,
                           std::map<std::string, std::string> variables) {
    flags.insert(flags.end(), {"--frames", "1", "--overwrite", "--stats", dir_ / "stats.json"});
    EXPECT_EQ(run(flags, {.variables = std::move(variables)}).code, 0);
    return stats().at(0).at("threads").get<int>();
  };
  EXPECT_EQ(threads({"--threads", "3"}, {{"SSDO_THREADS", "4"}}), 3);
  EXPECT_EQ(threads({}, {{"SSDO_THREADS", "4"}, {"CUE_THREADS", "5"}}), 4);
  EXPECT_EQ(threads({}, {{"CUE_THREADS", "5"}, {"SLURM_CPUS_PER_TASK", "6"}}), 5);
  EXPECT_EQ(threads({}, {{"SLURM_CPUS_PER_TASK", "6"}}), 6);
}

TEST_F(Shot, LayersOfAnotherSequenceFollowTheFrame) {
  for (const int frame : {1, 2}) write_frame(file("extra", frame), frame_of(small_picture()));
  const std::string aov = "normal=" + std::string(dir_ / "extra.####.exr") + ":ViewLayer.Normal";
  EXPECT_EQ(run({"--frames", "1-2", "--aov", aov}).code, 0);
  EXPECT_THAT(done(), ElementsAre(1, 2));
  const Finished missing = run({"--frames", "4", "--aov", aov});
  EXPECT_EQ(missing.code, 3);
  EXPECT_THAT(missing.error_line(), HasSubstr("extra.0004.exr"));
}

TEST_F(Shot, OtherPicturesFollowTheFrame) {
  write_frame(file("more", 1), frame_of(small_picture()));
  const Finished missing =
      run({"--frames", "1-2", "--also", dir_ / "more.####.exr", "--on-error", "continue", "-v"});
  EXPECT_THAT(missing.err, HasSubstr("more.0001.exr: 0 pixels show what the frame does not"));
  EXPECT_THAT(missing.err, HasSubstr("more.0002.exr: does not exist"));
  const Finished literal = run({"--frames", "2", "--also", dir_ / "all.exr"});
  EXPECT_EQ(literal.code, 3);
  EXPECT_THAT(literal.error_line(), HasSubstr("all.exr: does not exist"));
}

TEST_F(Shot, ADryRunAndAVerboseRunSayWhatTheyDo) {
  const Finished dry = run({"--frames", "1", "--dry-run"});
  EXPECT_EQ(dry.code, 0);
  EXPECT_TRUE(done().empty());
  EXPECT_THAT(dry.err, HasSubstr("fitted from P"));
  EXPECT_THAT(run({"--frames", "1", "-v"}).err, HasSubstr("fitted from P"));
}

TEST_F(Shot, OptionsMayComeFromAFile) {
  std::ofstream(dir_ / "options.toml") << "radius = \"0.25\"\nbounces = 3\n";
  EXPECT_EQ(run({"--frames", "1", "--config", dir_ / "options.toml", "--bounces", "2", "--stats",
                 dir_ / "stats.json"})
                .code,
            0);
  EXPECT_NEAR(stats().at(0)["plan"]["radius"].get<double>(), 0.25, 1e-6);
  EXPECT_EQ(stats().at(0)["bounces"], 2) << "the command line wins";
}

}  // namespace
}  // namespace ssdo::test::batch_test
