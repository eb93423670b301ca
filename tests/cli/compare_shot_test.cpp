// SPDX-License-Identifier: Apache-2.0
//
// ssdo compare on sequences through the real binary.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "support/frame_file.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::compare_shot_test {
namespace {

using nlohmann::json;
using testing::ContainsRegex;
using testing::HasSubstr;

const Window kAll{0, 0, 64, 48};

using Value = std::function<float(const glm::vec3& point)>;

class CompareShot : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return dir_ / name; }

  /// A layer that is the same everywhere.
  void write(const std::string& name, int frame, float value, const std::string& layer = "ao.Y",
             const Window& window = kAll) const {
    write_frame(file(name, frame),
                FramePart{"",
                          window,
                          window,
                          {{layer, Plane<float>(window.width(), window.height(), value)}},
                          Imf::FLOAT,
                          {}});
  }

  /// A G-buffer "g" of a camera that goes around a ball, and a layer "a" made of its points.
  void write_shot(int frames, const std::function<Value(int frame)>& value) const {
    const Surface scene = all_of({plane({}, {0, 0, 1}), sphere({0.2, 0, 0.6}, 0.6)});
    for (int n = 1; n <= frames; ++n) {
      const double angle = n * std::numbers::pi / 180;
      const Camera camera =
          look_at(camera_from_fov(40, kAll, 1), {4 * std::sin(angle), -4 * std::cos(angle), 3},
                  {0, 0, 0.3}, {0, 0, 1});
      const Picture picture = take_picture(scene, camera, kAll);
      write_frame(file("g", n), frame_of(picture));
      Plane<float> layer(kAll.width(), kAll.height(), 1);
      const Value of_point = value(n);
      for (std::size_t i = 0; i < layer.size(); ++i)
        if (picture.valid[i]) layer[i] = of_point(picture.position[i]);
      write_frame(file("a", n), FramePart{"", kAll, kAll, {{"ao.Y", layer}}, Imf::FLOAT, {}});
    }
  }

  std::string file(const std::string& name, int frame) const {
    return path(name + "." + std::to_string(frame) + ".exr");
  }

  Finished compare(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "compare");
    return run_tool(arguments);
  }

  json report(std::vector<std::string> arguments, int code = 0) const {
    arguments.push_back("--json");
    const Finished done = compare(arguments);
    EXPECT_EQ(done.code, code) << done.out << done.err;
    return parse_json(done.out);
  }

  /// Frames 1 to 3 of `a` and `b`; they differ by 0.1, 0.3 and 0.2.
  void write_three() const {
    for (const auto& [frame, value] : {std::pair{1, 0.6f}, {2, 0.8f}, {3, 0.7f}}) {
      write("a", frame, value);
      write("b", frame, 0.5f);
    }
  }

  std::string shot(const std::string& name) const { return path(name + ".@.exr"); }

  TempDir dir_;
};

TEST_F(CompareShot, HasALineForEachFrameATotalAndTheWorst) {
  write_three();
  const std::vector<std::string> both = {shot("a"), shot("b")};
  const json j = report(both);
  ASSERT_EQ(j.at("frames").size(), 3u);
  EXPECT_EQ(j.at("frames")[1].at("frame"), 2);
  EXPECT_NEAR(j.at("frames")[1].at("layers")[0].at("rmse"), 0.3, 1e-6);
  ASSERT_EQ(j.at("layers").size(), 1u);
  const json total = j.at("layers")[0];
  EXPECT_NEAR(total.at("rmse"), std::sqrt((0.01 + 0.09 + 0.04) / 3), 1e-6);
  EXPECT_NEAR(total.at("bias"), 0.2, 1e-6);
  EXPECT_NEAR(total.at("relative_rmse"), double(total.at("rmse")) / 0.5, 1e-6);
  EXPECT_NEAR(total.at("max"), 0.3, 1e-6);
  EXPECT_EQ(total.at("worst").at("frame"), 2);
  EXPECT_NEAR(total.at("worst").at("rmse"), 0.3, 1e-6);
  EXPECT_FALSE(total.contains("flicker"));

  const Finished done = compare(both);
  EXPECT_EQ(std::count(done.out.begin(), done.out.end(), '\n'), 1 + 3 + 2);
  EXPECT_THAT(done.out, ContainsRegex("\n +2 ao +3072 +0 +0.3 "));
  EXPECT_THAT(done.out, HasSubstr("RMSE 0.3 in frame 2"));
  EXPECT_EQ(done.err, "");
}

TEST_F(CompareShot, TheGateIsOverTheWorstFrame) {
  write_three();
  const auto code = [&](const std::string& bound, const std::string& frames) {
    return compare({shot("a"), shot("b"), "--fail-above", bound, "--frames", frames}).code;
  };
  EXPECT_EQ(code("0.31", "1-3"), 0);
  EXPECT_EQ(code("0.29", "1-3"), 1) << "the mean is below that";
  EXPECT_EQ(code("0.29", "1,3"), 0);
  EXPECT_EQ(report({shot("a"), shot("b"), "--frames", "3-1x2"}).at("frames")[0].at("frame"), 3);
}

TEST_F(CompareShot, AFrameThatOneSideLacksIsALineAndTheExitCode) {
  write_three();
  write("a", 4, 0.5f);
  std::filesystem::remove(file("b", 2));
  const json j = report({shot("a"), shot("b")}, 3);
  ASSERT_EQ(j.at("frames").size(), 4u);
  EXPECT_EQ(j.at("frames")[1].at("error").at("code"), 3);
  EXPECT_THAT(std::string(j.at("frames")[1].at("error").at("message")), HasSubstr("b.2.exr"));
  EXPECT_TRUE(j.at("frames")[1].at("layers").empty());
  EXPECT_FALSE(j.at("frames")[2].contains("error")) << "the others are compared";
  EXPECT_NEAR(j.at("layers")[0].at("rmse"), std::sqrt((0.01 + 0.04) / 2), 1e-6);
  const Finished done = compare({shot("a"), shot("b")});
  EXPECT_THAT(done.out, ContainsRegex("\n +2 [^\n]*b.2.exr: this frame does not exist\n"));
  EXPECT_THAT(done.out, ContainsRegex("\n +4 [^\n]*b.4.exr: this frame does not exist\n"));
  EXPECT_EQ(compare({shot("a"), shot("b"), "--frames", "1,3"}).code, 0);
  EXPECT_EQ(compare({shot("nothing"), shot("neither")}).code, 3);
}

TEST_F(CompareShot, OtherSizesAndLayersThatVanishAreLines) {
  write_three();
  write("a", 2, 0.8f, "ao.Y", {0, 0, 32, 24});
  json j = report({shot("a"), shot("b")}, 4);
  EXPECT_THAT(std::string(j.at("frames")[1].at("error").at("message")), HasSubstr("32 x 24"));
  write("b", 2, 0.8f, "ao.Y", {0, 0, 32, 24});
  j = report({shot("a"), shot("b")});
  EXPECT_THAT(j.at("frames")[1].at("notes").dump(), HasSubstr("32 x 24"));
  EXPECT_THAT(j.at("frames")[2].at("notes").dump(), HasSubstr("64 x 48"));

  for (const int frame : {1, 2, 3}) {
    std::map<std::string, Plane<float>> layers = {{"ao.Y", Plane<float>(64, 48, 0.5f)},
                                                  {"guessed.Y", Plane<float>(64, 48, 0.5f)}};
    write_frame(file("b", frame), FramePart{"", kAll, kAll, layers, Imf::FLOAT, {}});
    if (frame == 2) layers.erase("guessed.Y");
    write_frame(file("a", frame), FramePart{"", kAll, kAll, layers, Imf::FLOAT, {}});
  }
  j = report({shot("a"), shot("b")}, 4);
  EXPECT_EQ(j.at("frames")[0].at("layers").size(), 2u);
  EXPECT_EQ(j.at("frames")[1].at("layers").size(), 1u);
  EXPECT_THAT(j.at("frames")[1].at("notes").dump(),
              HasSubstr("has no guessed, as other frames have"));
  EXPECT_EQ(j.at("frames")[2].at("notes").size(), 0u);
}

TEST_F(CompareShot, WritesTheDifferenceOfEachFrame) {
  write_three();
  EXPECT_EQ(compare({shot("a"), shot("b"), "--diff", shot("d")}).code, 0);
  EXPECT_NEAR(channel(file("d", 3), "ao.Y")(5, 5), 0.2, 1e-6);
  EXPECT_EQ(compare({shot("a"), shot("b"), "--diff", path("one.exr")}).code, 2);
}

TEST_F(CompareShot, FlickerOfAFunctionOfThePointIsNearlyNothing) {
  write_shot(4, [](int) {
    return [](const glm::vec3& p) { return 0.5f + 0.3f * std::sin(1.5f * p.x + p.y); };
  });
  const json j = report({shot("a"), "--points", shot("g")});
  EXPECT_FALSE(j.at("frames")[0].at("layers")[0].contains("flicker")) << "nothing comes before it";
  for (const int frame : {1, 2, 3}) {
    const json flicker = j.at("frames")[frame].at("layers")[0].at("flicker");
    EXPECT_GT(flicker.at("points"), 2300);
    EXPECT_LT(flicker.at("rms"), 0.001);
    EXPECT_FALSE(flicker.contains("a_minus_b"));
  }
  EXPECT_LT(j.at("layers")[0].at("flicker").at("rms"), 0.001);
  EXPECT_NEAR(j.at("layers")[0].at("flicker").at("mean"), 0.5, 0.1);
  const Finished done = compare({shot("a"), "--points", shot("g")});
  EXPECT_EQ(std::count(done.out.begin(), done.out.end(), '\n'), 1 + 4 + 1);
}

TEST_F(CompareShot, AJumpInOneFrameIsTwoJumps) {
  write_shot(
      4, [](int frame) { return [frame](const glm::vec3&) { return frame == 3 ? 0.75f : 0.5f; }; });
  const json j = report({shot("a"), "--points", shot("g")});
  const auto rms = [&](int index) {
    return j.at("frames")[index].at("layers")[0].at("flicker").at("rms");
  };
  EXPECT_EQ(rms(1), 0);
  EXPECT_EQ(rms(2), 0.25);
  EXPECT_EQ(rms(3), 0.25);
  const json total = j.at("layers")[0].at("flicker");
  EXPECT_NEAR(total.at("rms"), 0.25 * std::sqrt(2 / 3.0), 0.002);
  EXPECT_NEAR(total.at("p99"), 0.25, 0.001);
  // Its truth jumps too.
  for (const int frame : {1, 2, 3, 4})
    std::filesystem::copy_file(file("a", frame), file("b", frame));
  const json both = report({shot("a"), shot("b"), "--points", shot("g"), "--fail-above", "0.001"});
  EXPECT_EQ(both.at("layers")[0].at("flicker").at("rms"), total.at("rms"));
  EXPECT_EQ(both.at("layers")[0].at("flicker").at("a_minus_b").at("rms"), 0);
  EXPECT_GT(both.at("layers")[0].at("flicker").at("a_minus_b").at("points"), 6900);
}

TEST_F(CompareShot, AMissingFrameOrMaskTakesPointsAway) {
  write_shot(4, [](int frame) { return [frame](const glm::vec3&) { return float(frame); }; });
  std::filesystem::remove(file("g", 2));
  const json j = report({shot("a"), "--points", shot("g")}, 3);
  EXPECT_THAT(std::string(j.at("frames")[1].at("error").at("message")), HasSubstr("g.2.exr"));
  EXPECT_FALSE(j.at("frames")[2].at("layers")[0].contains("flicker")) << "no frame before it";
  EXPECT_EQ(j.at("frames")[3].at("layers")[0].at("flicker").at("rms"), 1);
  // Frames that are left out on purpose: to the frame before in the list.
  const json two = report({shot("a"), "--points", shot("g"), "--frames", "1-4x2"});
  EXPECT_EQ(two.at("layers")[0].at("flicker").at("rms"), 2);
  Plane<float> mask(64, 48, 0);
  for (int y = 0; y < 48; ++y) mask(20, y) = 1;
  write_frame(path("mask.exr"), FramePart{"", kAll, kAll, {{"A", mask}}, Imf::FLOAT, {}});
  const json masked =
      report({shot("a"), "--points", shot("g"), "--frames", "3-4", "--mask", path("mask.exr")});
  EXPECT_LE(masked.at("layers")[0].at("flicker").at("points"), 48);
  EXPECT_GT(masked.at("layers")[0].at("flicker").at("points"), 20);
}

TEST_F(CompareShot, RefusesWhatDoesNotFit) {
  write_three();
  write_shot(1, [](int) { return [](const glm::vec3&) { return 1.0f; }; });
  const auto refused = [&](const std::vector<std::string>& arguments, const std::string& text) {
    const Finished done = compare(arguments);
    EXPECT_EQ(done.code, 2) << done.err;
    EXPECT_THAT(done.error_line(), HasSubstr(text));
  };
  refused({shot("a"), file("b", 1)}, "one is a sequence");
  refused({shot("a")}, "compare needs B");
  refused({file("a", 1), file("b", 1), "--frames", "1"}, "--frames needs a pattern");
  refused({file("a", 1), "--points", shot("g")}, "from frame to frame");
  refused({shot("a"), "--points", file("g", 1)}, "from frame to frame");
  refused({shot("a"), "--points", shot("g"), "--fail-above", "1"}, "there is no B");
  refused({shot("a"), shot("b"), "--camera", "c.json"}, "--points");
  write("a", 1, 1, "ao.Y", {0, 0, 32, 24});
  const json j = report({shot("a"), "--points", shot("g"), "--frames", "1"}, 4);
  EXPECT_THAT(std::string(j.at("frames")[0].at("error").at("message")), HasSubstr("32 x 24"));
}

}  // namespace
}  // namespace ssdo::test::compare_shot_test
