// SPDX-License-Identifier: Apache-2.0
//
// A shot with motion layers as Blender writes them: a box travels between others and under a beam
// that throws a sun's shadow on it.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

#include "estimators/bitmask/request.h"
#include "support/boxes.h"
#include "support/frame_file.h"
#include "support/run_tool.h"
#include "support/words.h"

namespace ssdo::test::shot_motion_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const Window kFrame{0, 0, 96, 72};
constexpr int kFrames = 9, kNow = 5;
constexpr double kStep = 0.07;

Surface moving_box(int frame) {
  const double x = kStep * (frame - kNow);
  return Box{{x - 0.35, -0.75, 0}, {x + 0.35, -0.2, 0.4}}.surface();
}

Surface scene(int frame) {
  return all_of({plane({}, {0, 0, 1}), plane({0, 1.2, 0}, {0, -1, 0}),
                 Box{{-1.3, -0.2, 0}, {-0.8, 0.3, 0.8}}.surface(),
                 Box{{0.7, -0.1, 0}, {1.2, 0.3, 0.6}}.surface(),
                 Box{{-0.1, -1, 0.9}, {0.1, 0.6, 1}}.surface(), moving_box(frame)});
}

Camera camera_at(int frame) {
  const double x = 0.1 * (frame - kNow);
  return look_at(camera_from_fov(45, kFrame, 1), {x, -4, 1.8}, {0.2 * x, 0, 0.3}, {0, 0, 1});
}

bool is_on_box(const glm::dvec3& p, int frame) {
  const double x = p.x - kStep * (frame - kNow);
  return std::abs(x) < 0.3501 && p.y > -0.7501 && p.y < -0.1999 && p.z > 1e-4 && p.z < 0.4001;
}

/// To the frame before, and from the frame after, y up.
void add_motion(FramePart& part, const Picture& picture, int frame, double scale) {
  Plane<float> vector[4];
  for (Plane<float>& plane : vector) plane = Plane<float>(kFrame.width(), kFrame.height(), 0.0f);
  for (std::size_t i = 0; i < picture.position.size(); ++i) {
    if (!picture.valid[i]) continue;
    const glm::dvec3 p(picture.position[i]), way(is_on_box(p, frame) ? kStep : 0, 0, 0);
    const auto place = [&](int of, const glm::dvec3& at) {
      return camera_at(of).project(camera_at(of).to_camera(at));
    };
    const glm::dvec2 now = place(frame, p), before = place(frame - 1, p - way) - now,
                     after = now - place(frame + 1, p + way);
    vector[0][i] = float(scale * before.x), vector[1][i] = float(-scale * before.y);
    vector[2][i] = float(scale * after.x), vector[3][i] = float(-scale * after.y);
  }
  for (int c = 0; c < 4; ++c)
    part.channels[std::string("ViewLayer.Vector.") + "XYZW"[c]] = vector[c];
}

class AShotWithMotion : public testing::Test {
 protected:
  AShotWithMotion() { write("moves", 1), write("none", 0); }

  fs::path file(const std::string& name, int frame) const {
    return folder / fmt::format("{}.{:04}.exr", name, frame);
  }
  void write(const std::string& name, double scale) const {
    for (int frame = 1; frame <= kFrames; ++frame) {
      const Picture picture = take_picture(scene(frame), camera_at(frame), kFrame);
      FramePart part = frame_of(picture);
      if (scale != 0) add_motion(part, picture, frame, scale);
      write_frame(file(name, frame), part);
    }
  }
  Finished run(const std::string& name, const std::string& out, const Words& more,
               const Surroundings& around = {}) const {
    return run_tool(Words{folder / (name + ".####.exr"), "-o", folder / (out + ".####.exr"),
                          "--pixel-type", "float", "--products", "ao,shadow", "--light",
                          "distant direction=0.3,0.5,-1 angle=2"} +
                        more,
                    around);
  }
  Plane<float> found(const std::string& out, int frame, const std::string& layer) const {
    return channel(file(out, frame), layer);
  }

  TempDir folder;
};

TEST_F(AShotWithMotion, IsSteadierAndAsNearToRaysOnWhatMoves) {
  // By rules, which change most from frame to frame.
  const Words shot = {"--shot", "4", "--frames", "4-5", "--prior", "rules", "-q"};
  ASSERT_EQ(run("none", "alone", shot).err, "");
  ASSERT_EQ(run("moves", "shot", shot).err, "");
  const Picture picture = take_picture(scene(kNow), camera_at(kNow), kFrame);
  const auto measure = [&](const std::string& out) {
    const Plane<float> here = found(out, kNow, "ao.Y"), before = found(out, kNow - 1, "ao.Y");
    double error = 0, change = 0;
    int errors = 0, changes = 0;
    for (int y = 0; y < kFrame.height(); y += 2) {
      for (int x = 0; x < kFrame.width(); x += 2) {
        const glm::dvec3 p(picture.position(x, y));
        if (!picture.valid(x, y) || !is_on_box(p, kNow)) continue;
        const auto open = [&](int frame, const glm::dvec3& at) {
          return ao_by_rays(scene(frame), {at, glm::dvec3(picture.normal(x, y))}, kNoLimit, 256);
        };
        const double now = open(kNow, p);
        error += std::pow(double(here(x, y)) - now, 2), ++errors;
        const glm::dvec3 was = p - glm::dvec3(kStep, 0, 0);
        const Camera last = camera_at(kNow - 1);
        const glm::dvec2 at = last.project(last.to_camera(was));
        const int u = int(std::floor(at.x)), v = int(std::floor(at.y));
        const Point q = point_at(scene(kNow - 1), last, kFrame, u, v);
        if (glm::distance(q.position, was) > 0.05) continue;
        const double real = now - open(kNow - 1, was);
        change += std::pow(double(here(x, y)) - double(before(u, v)) - real, 2), ++changes;
      }
    }
    EXPECT_GT(changes, 50);
    return std::pair(std::sqrt(error / errors), std::sqrt(change / changes));
  };
  const auto [error_alone, change_alone] = measure("alone");
  const auto [error, change] = measure("shot");
  fmt::print("on what moves: RMSE {:.4f} without motion, {:.4f} with it; change {:.4f}, {:.4f}\n",
             error_alone, error, change_alone, change);
  EXPECT_LT(error, 1.03 * error_alone);
  EXPECT_LT(change, 0.85 * change_alone);
}

/// The shadow of the beam lies on the box where it is now, and what stands still is as without
/// motion.
TEST_F(AShotWithMotion, DragsNoShadowAlong) {
  // Frames of a shot have their numbers as seeds.
  ASSERT_EQ(run("none", "alone", {"--frames", "5", "--seed", "5"}).err, "");
  ASSERT_EQ(run("none", "still", {"--shot", "4", "--frames", "5"}).err, "");
  ASSERT_EQ(run("moves", "shot", {"--shot", "4", "--frames", "5"}).err, "");
  const Picture picture = take_picture(scene(kNow), camera_at(kNow), kFrame);
  const Plane<float> shadow = found("shot", kNow, "shadow.R"),
                     alone = found("alone", kNow, "shadow.R"), ao = found("shot", kNow, "ao.Y"),
                     still = found("still", kNow, "ao.Y");
  int lit = 0, dark = 0;
  double off = 0;
  for (std::size_t i = 0; i < shadow.size(); ++i) {
    if (!picture.valid[i]) continue;
    if (!is_on_box(glm::dvec3(picture.position[i]), kNow)) {
      EXPECT_EQ(ao[i], still[i]);
      continue;
    }
    lit += alone[i] > 0.9f, dark += alone[i] < 0.1f;
    off += double(std::abs(shadow[i] - alone[i]));
  }
  EXPECT_GT(lit, 100);
  EXPECT_GT(dark, 20);
  EXPECT_LT(off / (lit + dark), 0.003);
}

TEST_F(AShotWithMotion, HasTheSameBitsHoweverItIsCut) {
  ASSERT_EQ(run("moves", "whole", {"--shot", "2"}).code, 0);
  const std::vector<Words> cuts = {{"--frames", "4"}, {"--frames", "3-4", "--threads", "1"}};
  for (const Words& cut : cuts) {
    ASSERT_EQ(run("moves", "cut", Words{"--shot", "2"} + cut).code, 0);
    for (const char* layer : {"ao.Y", "shadow.R"})
      EXPECT_EQ(found("cut", 4, layer).pixels, found("whole", 4, layer).pixels) << layer;
    for (const int frame : {3, 4}) fs::remove(file("cut", frame));
  }
}

/// What moves is followed through frames that wait on disk.
TEST_F(AShotWithMotion, HasTheSameBitsFromDisk) {
  const Words shot = {"--shot", "3", "--frames", "5", "--threads", "2"};
  ASSERT_EQ(run("moves", "whole", shot).code, 0);
  const Words little = shot + Words{"--mem-limit", "176.2M"};
  const std::string nowhere = folder / "nowhere";
  EXPECT_THAT(run("moves", "no_room", little, {.variables = {{"TMPDIR", nowhere}}}).err,
              HasSubstr(nowhere + ": cannot keep"))
      << "not all fits into memory";
  ASSERT_EQ(run("moves", "little", little, {.variables = {{"TMPDIR", folder.path()}}}).code, 0);
  for (const char* layer : {"ao.Y", "shadow.R"})
    EXPECT_EQ(found("little", 5, layer).pixels, found("whole", 5, layer).pixels) << layer;
}

TEST_F(AShotWithMotion, UnitsThatContradictTheCamerasAreNamed) {
  write("wrong", -1);
  const Words shot = {"--shot", "1", "--frames", "5"};
  const Finished wrong = run("wrong", "wrong_out", shot);
  EXPECT_EQ(wrong.code, 0);
  EXPECT_THAT(wrong.err, HasSubstr("ViewLayer.Vector moves other ways than the cameras say"));
  ASSERT_EQ(run("none", "none_out", shot).code, 0);
  EXPECT_EQ(found("wrong_out", 5, "ao.Y").pixels, found("none_out", 5, "ao.Y").pixels);
  ASSERT_EQ(run("wrong", "scaled", shot + Words{"--motion-scale", "-1,-1"}).err, "");
  ASSERT_EQ(run("moves", "right", shot).err, "");
  const Plane<float> scaled = found("scaled", 5, "ao.Y"), right = found("right", 5, "ao.Y");
  EXPECT_EQ(scaled.pixels, right.pixels);
}

}  // namespace
}  // namespace ssdo::test::shot_motion_test
