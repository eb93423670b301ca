// SPDX-License-Identifier: Apache-2.0
//
// What a run over a shot says at its end of what differs between the frames, in lines and in
// --stats.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "support/analytic_scene.h"
#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::shot_report_test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const Window kWindow{0, 0, 64, 48};

Picture take(double along, const Window& window = kWindow) {
  const Surface scene =
      all_of({plane({}, {0, 0, 1}), plane({0, 6, 0}, {0, -1, 0}), sphere({0.2, 0, 1}, 1)});
  const Camera camera =
      look_at(camera_from_fov(40, window, 1), {along, -6, 2.5}, {along, 0, 0.6}, {0, 0, 1});
  return take_picture(scene, camera, window);
}

class ReportOfAShot : public testing::Test {
 protected:
  /// Six frames of a camera that goes slowly to the side, numbered from 7.
  ReportOfAShot() {
    for (int frame = 7; frame <= 12; ++frame) write_frame(file(frame), part(frame));
  }
  static FramePart part(int frame) { return frame_of(take(0.05 * frame)); }
  static FramePart without_albedo(int frame) {
    FramePart made = part(frame);
    for (const char* c : {"R", "G", "B"})
      made.channels.erase(std::string("ViewLayer.DiffCol.") + c);
    return made;
  }

  std::string file(int frame) const { return dir_ / fmt::format("in.{:04}.exr", frame); }
  std::string sequence() const { return dir_ / "in.####.exr"; }
  Finished run(std::vector<std::string> flags) const {
    flags.insert(flags.begin(), {sequence(), "-o", dir_ / "out.####.exr", "--overwrite",
                                 "--quality", "draft", "--stats", dir_ / "stats.json"});
    Finished done = run_tool(flags);
    EXPECT_EQ(done.code, 0) << done.err;
    return done;
  }
  /// What follows the name of the sequence in its lines.
  std::vector<std::string> summary_of(const Finished& done) const {
    const std::string begin = "ssdo: " + sequence() + ": ";
    std::vector<std::string> lines;
    std::istringstream in(done.err);
    for (std::string line; std::getline(in, line);)
      if (line.starts_with(begin)) lines.push_back(line.substr(begin.size()));
    return lines;
  }
  std::map<int, json> shot() const {
    std::map<int, json> found;
    for (const json& entry : parse_json(read_file(dir_ / "stats.json")))
      found[entry["frame"]] = entry["shot"];
    return found;
  }
  TempDir dir_;
};

TEST_F(ReportOfAShot, IsEmptyWhereNothingDiffers) {
  EXPECT_EQ(run({}).err, "");
  const std::map<int, json> frames = shot();
  ASSERT_EQ(frames.size(), 6u);
  for (const auto& [frame, told] : frames) {
    EXPECT_EQ(told["changes"], json::array());
    EXPECT_EQ(told["camera_jumps"], false);
    EXPECT_EQ(told["camera_step"].is_null(), frame == 7);
    EXPECT_FALSE(told.contains("radius_alone")) << "without a limit there is none";
    EXPECT_GT(told["guessed"], 0.0);
    EXPECT_EQ(told.contains("summary"), frame == 12) << "the last one has it";
  }
  EXPECT_NEAR(frames.at(9).at("camera_step"), frames.at(12).at("camera_step"), 1e-3);
}

TEST_F(ReportOfAShot, NamesLayersWithTheirFrames) {
  for (const int frame : {9, 10, 12}) write_frame(file(frame), without_albedo(frame));
  const Finished done = run({});
  const std::string expected =
      "warning: albedo: 'ViewLayer.DiffCol' (float) in frames 7 to 8, 11, none in frames 9 to 10, "
      "12";
  EXPECT_THAT(summary_of(done), Contains(expected));
  const std::map<int, json> frames = shot();
  EXPECT_THAT(frames.at(12)["summary"].get<std::vector<std::string>>(),
              Contains(sequence() + ": " + expected));
  EXPECT_THAT(frames.at(9)["changes"].dump(), HasSubstr("albedo is gone"));
  EXPECT_THAT(frames.at(11)["changes"].dump(), HasSubstr("albedo is new"));
  EXPECT_THAT(frames.at(12)["changes"].dump(), HasSubstr("albedo is gone"));
  // What repeats is not printed again when it happens.
  EXPECT_THAT(done.err, HasSubstr("in.0009.exr: warning: albedo is gone"));
  EXPECT_THAT(done.err, Not(HasSubstr("in.0012.exr: warning: albedo is gone")));

  const Finished quiet = run({"-q"});
  EXPECT_EQ(quiet.err, "");
  EXPECT_THAT(shot().at(12)["summary"].get<std::vector<std::string>>(),
              AllOf(Contains(sequence() + ": " + expected),
                    Contains(EndsWith("--aov albedo=LAYER: frames 9 to 10, 12"))))
      << "also without lines";
  EXPECT_THAT(summary_of(run({"-v"})), Contains(expected));
  EXPECT_THAT(summary_of(run({"--dry-run"})),
              AllOf(Contains(expected), Contains(EndsWith("frames 9 to 10, 12"))));
  const Finished info = run_tool({"info", sequence()});
  EXPECT_THAT(summary_of(info), Contains(expected));
  EXPECT_THAT(summary_of(run({"--frames", "9-10"})), Not(Contains(HasSubstr("albedo: "))));
}

TEST_F(ReportOfAShot, NamesTypesAndSizes) {
  for (int frame = 10; frame <= 12; ++frame) {
    FramePart half = part(frame);
    half.type = Imf::HALF;
    write_frame(file(frame), half);
  }
  write_frame(file(8), frame_of(take(0.4, {0, 0, 32, 24})));
  const Finished done = run({});
  EXPECT_THAT(done.err, HasSubstr("in.0010.exr: warning: position is of another type: float in "
                                  "frame 9, half in frame 10"));
  EXPECT_THAT(summary_of(done),
              AllOf(Contains("warning: size: 64 x 48 in frames 7, 9 to 12, 32 x 24 in frame 8"),
                    Contains("warning: position: 'ViewLayer.Position' (float) in frames 7 to 9, "
                             "'ViewLayer.Position' (half) in frames 10 to 12")));
  EXPECT_EQ(shot().at(9)["camera_jumps"], false) << "the size is no motion";
}

TEST_F(ReportOfAShot, NamesCuts) {
  for (int frame = 10; frame <= 12; ++frame)
    write_frame(file(frame), frame_of(take(0.05 * frame + 4)));
  const std::vector<std::string> lines = summary_of(run({}));
  EXPECT_THAT(lines, ElementsAre(HasSubstr("warning: the camera jumps, as at a cut, from frame 9 "
                                           "to 10: what it shows moves by 0.")));
  for (const auto& [frame, told] : shot()) EXPECT_EQ(told["camera_jumps"], frame == 10) << frame;
  run({"--frames", "12-7"});
  for (const auto& [frame, told] : shot()) EXPECT_EQ(told["camera_jumps"], frame == 10) << frame;
  EXPECT_THAT(summary_of(run({"--frames", "10-12"})), IsEmpty());
}

/// How much of a shot is guessed is one line; run_tool() takes it away, and --stats has it.
TEST_F(ReportOfAShot, SaysHowMuchIsGuessed) {
  const auto told = [&](const std::vector<std::string>& flags) {
    run(flags);
    const json all = parse_json(read_file(dir_ / "stats.json"));
    return all.back()["shot"]["summary"].get<std::vector<std::string>>();
  };
  double least = 1, most = 0;
  const std::vector<std::string> lines = told({});
  for (const auto& [frame, entry] : shot()) {
    least = std::min(least, double(entry["guessed"]));
    most = std::max(most, double(entry["guessed"]));
  }
  ASSERT_GT(most, 0.3);
  const std::string range = fmt::format("{:.2f}", least) == fmt::format("{:.2f}", most)
                                ? fmt::format("{:.2f}", most)
                                : fmt::format("{:.2f} to {:.2f}", least, most);
  EXPECT_THAT(lines, ElementsAre(AllOf(
                         testing::StartsWith(sequence() + ": " + range +
                                             " of all directions are guessed; most in frame "),
                         HasSubstr(": render "))));
  EXPECT_THAT(told({"--radius", "0.2"}), IsEmpty()) << "little is";
  EXPECT_THAT(told({"--frames", "9"}), IsEmpty()) << "one frame is no shot";
}

TEST_F(ReportOfAShot, IsNotThatOfAFrameAlone) {
  ASSERT_EQ(run_tool({file(9), "-o", dir_ / "alone.exr", "--stats", dir_ / "alone.json"}).code, 0);
  EXPECT_FALSE(parse_json(read_file(dir_ / "alone.json"))[0].contains("shot"));
}

}  // namespace
}  // namespace ssdo::test::shot_report_test
