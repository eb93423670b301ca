// SPDX-License-Identifier: Apache-2.0
//
// Frames before and after as other views, by the tool on real sequences: what they add, against
// rays through the very scene, and which of them are used.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>

#include "estimators/bitmask/request.h"
#include "support/boxes.h"
#include "support/error_matchers.h"
#include "support/frame_file.h"
#include "support/run_tool.h"

namespace ssdo::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const Window kFrame{0, 0, 96, 72};

/// Boxes in a row on a floor, each of which hides a part of it.
Surface boxes() {
  std::vector<Surface> things = {plane({}, {0, 0, 1})};
  for (const double x : {-1.1, 0.0, 1.1})
    things.push_back(Box{{x - 0.3, -0.4, 0}, {x + 0.3, 0, 0.9}}.surface());
  return all_of(things);
}

/// A camera that moves past them: frame 3 is in the middle.
Camera passing(int frame) {
  const double x = 1.3 * (frame - 3);
  return look_at(camera_from_fov(45, kFrame, 1), {x, -4, 1.3}, {0.2 * x, 0, 0.3}, {0, 0, 1});
}

class NeighboursOf : public testing::Test {
 protected:
  std::string file(int frame, const std::string& name = "in") const {
    return folder / fmt::format("{}.{:04}.exr", name, frame);
  }
  void write(int frame, const Surface& scene) const {
    write_frame(file(frame), frame_of(take_picture(scene, passing(frame), kFrame)));
  }
  void write_shot() const {
    for (int frame = 1; frame <= 5; ++frame) write(frame, boxes());
  }
  Finished run(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {
        folder / "in.####.exr", "-o",        folder / "out.####.exr", "--overwrite",
        "--products",           "ao,bounce", "--pixel-type",          "float"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_tool(arguments);
  }
  Plane<float> ao(int frame, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"--frames", std::to_string(frame)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished done = run(arguments);
    EXPECT_EQ(done.code, 0) << done.err;
    return channel(file(frame, "out"), "ao.Y");
  }
  /// What `info` prints, or the error.
  std::string info(int frame, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"info", folder / "in.####.exr", "--frames",
                                          std::to_string(frame)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Finished done = run_tool(arguments);
    EXPECT_EQ(done.code, 0) << done.err;
    return done.out;
  }
  /// The line of a plan that says what a view adds begins so.
  static std::string adds(int frame) { return fmt::format(" in.{:04}.exr: ", frame); }

  TempDir folder;
};

TEST_F(NeighboursOf, AMovingCameraShowWhatTheFrameHides) {
  write_shot();
  const Surface scene = boxes();
  const auto rmse = [&](const Plane<float>& ao) {
    double sum = 0;
    int count = 0;
    for (int y = 8; y < kFrame.height() - 8; y += 4) {
      for (int x = 8; x < kFrame.width() - 8; x += 4) {
        const Point p = point_at(scene, passing(3), kFrame, x, y);
        if (p.position.z > 1e-6 || glm::length(p.position) > 2) continue;
        sum += std::pow(double(ao(x, y)) - ao_by_rays(scene, p, kNoLimit, 1024), 2);
        ++count;
      }
    }
    EXPECT_GT(count, 40);
    return std::sqrt(sum / count);
  };
  for (const std::string method : {"bitmask", "trace"}) {
    std::vector<std::string> by = {"--method", method, "--quality", "final"};
    if (method == "trace") by = {"--method", method, "--set", "samples=256"};
    const double alone = rmse(ao(3, by));
    by.insert(by.end(), {"--neighbours", "2"});
    const double known = rmse(ao(3, by));
    fmt::print("{}: RMSE {:.4f} alone, {:.4f} with two frames before and after\n", method, alone,
               known);
    EXPECT_LT(known, 0.85 * alone) << method;
  }
}

TEST_F(NeighboursOf, AFrameAreTheViewsThatAlsoWouldName) {
  write_shot();
  const Plane<float> alone = ao(3), near = ao(3, {"--neighbours", "1"}),
                     far = ao(3, {"--neighbours", "1x2"});
  EXPECT_NE(alone.pixels, near.pixels);
  EXPECT_NE(near.pixels, far.pixels);
  EXPECT_EQ(near.pixels, ao(3, {"--also", file(2), "--also", file(4)}).pixels);
  EXPECT_EQ(far.pixels, ao(3, {"--also", file(1), "--also", file(5)}).pixels);
  // Each file counts once, and both options add up.
  EXPECT_EQ(near.pixels, ao(3, {"--neighbours", "1", "--also", folder / "./in.0004.exr"}).pixels);
  EXPECT_EQ(ao(3, {"--neighbours", "1", "--also", file(1)}).pixels,
            ao(3, {"--also", file(1), "--also", file(2), "--also", file(4)}).pixels);
}

TEST_F(NeighboursOf, TheEndsOfAShotAreThoseThatExist) {
  write_shot();
  fs::remove(file(2));
  const std::string at_end = info(1, {"--neighbours", "3"});
  EXPECT_THAT(at_end, AllOf(HasSubstr(adds(3)), HasSubstr(adds(4)), Not(HasSubstr(adds(5)))));
  EXPECT_THAT(at_end, WarnsOfNothing());
  EXPECT_EQ(run({"--frames", "5", "--neighbours", "4x1000"}).code, 0);
}

TEST_F(NeighboursOf, ARunHaveTheSameBitsInOneRunFrameByFrameAndForAnyThreads) {
  write_shot();
  fs::remove(file(2));  // so that no frame has all of its neighbours
  std::map<int, Plane<float>> apart;
  for (const int frame : {1, 3, 4, 5}) apart[frame] = ao(frame, {"--neighbours", "2"});
  for (const std::string threads : {"1", "2"}) {
    ASSERT_EQ(run({"--neighbours", "2", "--threads", threads}).code, 0);
    for (const auto& [frame, pixels] : apart)
      EXPECT_EQ(channel(file(frame, "out"), "ao.Y").pixels, pixels.pixels) << frame;
  }
  ASSERT_EQ(run({"--neighbours", "2", "--also", file(4), "--frames", "5,1"}).code, 0);
  EXPECT_EQ(channel(file(1, "out"), "ao.Y").pixels,
            ao(1, {"--neighbours", "2", "--also", file(4)}).pixels);
}

/// A frame that takes its camera from another does not read its neighbours with it: the next frame,
/// which tells its own, has the same neighbour.
TEST_F(NeighboursOf, AFrameWithoutACameraAreReadAsThoseOfOthers) {
  write_shot();
  for (const int frame : {2, 3}) {
    Picture picture = take_picture(boxes(), passing(frame), kFrame);
    for (std::size_t i = 0; i < picture.position.size(); ++i)
      if (i % 96 < 40 || i % 96 > 55 || i / 96 != 50)
        picture.position[i] = picture.normal[i] = glm::vec3(0);
    write_frame(file(frame), frame_of(picture));
  }
  const Plane<float> apart = ao(4, {"--neighbours", "1"});
  ASSERT_EQ(run({"--neighbours", "1", "--frames", "2-4"}).code, 0);
  EXPECT_EQ(channel(file(4, "out"), "ao.Y").pixels, apart.pixels);
}

TEST_F(NeighboursOf, AMovingThingAreLeftOutWhereItWas) {
  const Surface still = all_of({plane({}, {0, 0, 1}), Box{{0.8, 0, 0}, {1.2, 0.4, 0.6}}.surface()});
  const auto with_ball = [&](double x) { return all_of({still, sphere({x, -0.4, 0.45}, 0.45)}); };
  write(2, with_ball(-1.1));
  write(3, with_ball(0));
  const Plane<float> known = ao(3, {"--neighbours", "1"}), alone = ao(3);
  // On the floor around a place: where the ball was nothing of it is left, and where it is now the
  // other frame, which looks through it there, does not make it thinner.
  const auto rmse_near = [&](double x, const Plane<float>& ao) {
    double sum = 0;
    int count = 0;
    for (int py = 30; py < kFrame.height(); py += 2) {
      for (int px = 0; px < kFrame.width(); px += 2) {
        const Point p = point_at(with_ball(0), passing(3), kFrame, px, py);
        if (p.position.z > 1e-6 || glm::distance(p.position, glm::dvec3(x, -0.4, 0)) > 0.8)
          continue;
        const double rays = ao_by_rays(with_ball(0), p, kNoLimit, 256);
        sum += std::pow(double(ao(px, py)) - rays, 2), ++count;
      }
    }
    EXPECT_GT(count, 40);
    return std::sqrt(sum / count);
  };
  const double was = rmse_near(-1.1, known), is = rmse_near(0, known), beside = rmse_near(1, known),
               is_alone = rmse_near(0, alone), beside_alone = rmse_near(1, alone);
  fmt::print(
      "RMSE {:.4f} where the ball was; {:.4f} (alone {:.4f}) where it is, {:.4f} ({:.4f}) "
      "beside it\n",
      was, is, is_alone, beside, beside_alone);
  EXPECT_LT(was, 0.04);
  EXPECT_LT(is, 1.1 * is_alone);
  EXPECT_LT(beside, 1.1 * beside_alone);
  const std::string told = info(3, {"--neighbours", "1"});
  EXPECT_THAT(told, testing::ContainsRegex("[1-9][0-9]+ contradict it"));
  EXPECT_THAT(told, WarnsOfNothing()) << "things move in a shot";
}

TEST_F(NeighboursOf, AFrameThatCannotBeUsedAreLeftOutWithAWarning) {
  write_shot();
  const Plane<float> alone = ao(3, {"--neighbours", "1"});
  // One that is cut short, one that holds no P, one of another scene after a cut.
  fs::resize_file(file(1), fs::file_size(file(1)) / 2);
  FramePart part = frame_of(take_picture(boxes(), passing(5), kFrame));
  for (const char* c : {"X", "Y", "Z"}) part.channels.erase(std::string("ViewLayer.Position.") + c);
  write_frame(file(5), part);
  write(6, all_of({plane({0, 0, 0.6}, {0, 0, 1}), sphere({0, 1, 1}, 0.7)}));
  const Finished done = run({"--frames", "3", "--neighbours", "3"});
  EXPECT_EQ(done.code, 0);
  EXPECT_THAT(done.err, AllOf(HasSubstr("left out as a neighbour: " + file(1) + ": is damaged"),
                              HasSubstr("left out as a neighbour: " + file(5) +
                                        ": has depth but no position"),
                              HasSubstr(file(6) + ": left out: ")));
  EXPECT_EQ(channel(file(3, "out"), "ao.Y").pixels, alone.pixels);
  EXPECT_THAT(info(3, {"--neighbours", "3"}), Not(HasSubstr(adds(6) + "0 pixels")));
}

TEST_F(NeighboursOf, AFrameAreReadAsItIs) {
  const auto rename = [&](int frame) {
    FramePart part = frame_of(take_picture(boxes(), passing(frame), kFrame));
    for (const std::string c : {"X", "Y", "Z"}) {
      auto node = part.channels.extract("ViewLayer.Position." + c);
      node.key() = "where." + c;
      part.channels.insert(std::move(node));
    }
    write_frame(file(frame), part);
  };
  for (int frame = 2; frame <= 4; ++frame) rename(frame);
  EXPECT_THAT(info(3, {"--neighbours", "1", "--aov", "position=where"}),
              AllOf(HasSubstr(adds(2)), HasSubstr(adds(4)), WarnsOfNothing()));
  // Layers of other files follow the neighbours' frames.
  write_shot();
  for (int frame = 2; frame <= 4; ++frame) fs::rename(file(frame), file(frame, "more"));
  for (int frame = 2; frame <= 4; ++frame) rename(frame);
  const std::string of_more =
      "position=" + std::string(folder / "more.####.exr") + ":ViewLayer.Position";
  EXPECT_THAT(info(3, {"--neighbours", "1", "--aov", of_more}),
              AllOf(HasSubstr(adds(2)), HasSubstr(adds(4)), WarnsOfNothing()));
}

TEST_F(NeighboursOf, AFrameWithoutWorldOrASingleFileAreRefused) {
  Picture own = take_picture(boxes(), passing(3), kFrame);
  for (std::size_t i = 0; i < own.position.size(); ++i)
    if (own.valid[i])
      own.position[i] = glm::vec3(own.camera.to_camera(glm::dvec3(own.position[i])));
  own.camera = camera_from_fov(45, kFrame, 1);
  for (int frame = 1; frame <= 2; ++frame) write_frame(file(frame), frame_of(own));
  const Finished no_world = run({"--frames", "1", "--neighbours", "1"});
  EXPECT_EQ(no_world.code, 4);
  EXPECT_THAT(no_world.error_line(), AllOf(HasSubstr("--neighbours"), HasSubstr("--camera")));

  const Finished single = run_tool({file(1), "-o", folder / "out.exr", "--neighbours", "1"});
  EXPECT_EQ(single.code, 2);
  EXPECT_THAT(single.error_line(), HasSubstr("--neighbours needs a frame pattern"));
  EXPECT_EQ(run_tool({"bench", file(1), "--neighbours", "1"}).code, 2);

  const Finished onto_neighbour = run_tool(
      {folder / "in.####.exr", "-o", file(2), "--frames", "1", "--overwrite", "--neighbours", "1"});
  EXPECT_EQ(onto_neighbour.code, 5);
  EXPECT_THAT(onto_neighbour.error_line(), HasSubstr("is an input (--neighbours)"));
}

TEST_F(NeighboursOf, AFrameHaveNoEffectOnMethodsWithoutThickness) {
  write_shot();
  const Finished done = run_tool({folder / "in.####.exr", "-o", folder / "out.####.exr", "--frames",
                                  "3", "--neighbours", "1", "--method", "ssao"});
  EXPECT_EQ(done.code, 0);
  EXPECT_THAT(done.err, HasSubstr("--neighbours has no effect: method ssao"));
}

}  // namespace
}  // namespace ssdo::test
