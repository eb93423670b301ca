// SPDX-License-Identifier: Apache-2.0
//
// Which steps of a camera from frame to frame are told as jumps.
#include "jobs/sequence/camera_steps.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "support/analytic_scene.h"

namespace ssdo::test::camera_steps_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const Window kPicture{0, 0, 160, 90};
constexpr double kDepth = 5;

CameraOfFrame at(int number, const glm::dvec3& eye, const glm::dvec3& target, double fov = 40) {
  return {number, look_at(camera_from_fov(fov, kPicture, 1), eye, target, {0, 0, 1}), kPicture,
          kDepth};
}

/// A camera that looks to the side by an angle, in degrees.
CameraOfFrame turned(int number, double degrees) {
  const double a = degrees * M_PI / 180;
  return at(number, {}, {std::sin(a), std::cos(a), 0});
}

std::vector<int> jumps(const std::vector<CameraOfFrame>& cameras) {
  std::vector<int> to;
  for (const CameraStep& step : camera_steps(cameras))
    if (step.jumps) to.push_back(step.to);
  return to;
}

std::vector<CameraOfFrame> turning(const std::vector<double>& angles) {
  std::vector<CameraOfFrame> cameras;
  for (const double angle : angles) cameras.push_back(turned(int(cameras.size()) + 1, angle));
  return cameras;
}

TEST(CameraSteps, AreMeasuredInWidthsOfThePicture) {
  const CameraOfFrame still = at(1, {}, {0, 1, 0});
  EXPECT_NEAR(widths_between(still, at(2, {}, {0, 1, 0})), 0, 1e-12);
  // A picture of the surfaces at this depth is so wide, in scene units.
  const double width = 2 * kDepth * std::tan(20 * M_PI / 180);
  EXPECT_NEAR(widths_between(still, at(2, {0.1 * width, 0, 0}, {0.1 * width, 1, 0})), 0.1, 1e-9);
  EXPECT_NEAR(widths_between(still, at(2, {0, 0, 0.1 * width}, {0, 1, 0.1 * width})), 0.1, 1e-9);
  EXPECT_NEAR(widths_between(still, at(2, {}, {0, -1, 0})), 1, 1e-12) << "all of it is behind";
  EXPECT_NEAR(widths_between(still, at(2, {0, -1e6, 0}, {0, 1, 0})),
              (4 * std::hypot(0.5, 0.5 * 9 / 16) + 2 * 0.5 + 2 * 0.5 * 9 / 16) / 9, 1e-4)
      << "far away, all of it shrinks to the centre";
  CameraOfFrame large = at(2, {}, {0, 1, 0});
  large.display = {0, 0, 320, 180};
  large.camera.fx *= 2, large.camera.fy *= 2, large.camera.cx *= 2, large.camera.cy *= 2;
  EXPECT_NEAR(widths_between(still, large), 0, 1e-12) << "another size is no motion";
}

TEST(CameraSteps, JumpAtCuts) {
  EXPECT_THAT(jumps(turning({0, 1, 2, 3, 40, 41, 42})), ElementsAre(5));
  EXPECT_THAT(jumps(turning({0, 40})), ElementsAre(2)) << "with nothing to compare it to";
  EXPECT_THAT(jumps(turning({0, 1, 2, 60, 4, 5, 6})), ElementsAre(4, 5)) << "one frame is wrong";
  std::vector<CameraOfFrame> zoomed;
  for (int i = 1; i <= 6; ++i) zoomed.push_back(at(i, {}, {0, 1, 0}, i < 4 ? 80 : 12));
  EXPECT_THAT(jumps(zoomed), ElementsAre(4));
}

TEST(CameraSteps, OfAMovingCameraDoNotJump) {
  EXPECT_THAT(jumps(turning({0, 1, 2, 3, 4, 5})), IsEmpty());
  EXPECT_THAT(jumps(turning({0, 0, 1, 3, 9, 24, 41, 58, 75, 84, 88, 89, 89})), IsEmpty())
      << "a quick pan that begins and ends slowly";
}

TEST(CameraSteps, AreInTheOrderOfTheirNumbers) {
  std::vector<CameraOfFrame> cameras = turning({0, 1, 2, 3, 40, 41, 42});
  std::ranges::reverse(cameras);
  EXPECT_THAT(jumps(cameras), ElementsAre(5));
  for (CameraOfFrame& camera : cameras) camera.number *= 10;
  EXPECT_THAT(jumps(cameras), IsEmpty()) << "ten frames apart, nobody knows";
  EXPECT_THAT(camera_steps({cameras[0], cameras[0]}), IsEmpty());
}

}  // namespace
}  // namespace ssdo::test::camera_steps_test
