// SPDX-License-Identifier: Apache-2.0
#include "scene/camera/fit.h"

#include <Imath/half.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <random>

#include "scene/camera/fit_pose.h"
#include "support/analytic_scene.h"

namespace ssdo::test::fit_test {
namespace {

const Window kWindow{0, 0, 160, 90};

/// Ground and spheres: positions that fill space.
Surface still_life(const glm::dvec3& offset = glm::dvec3(0)) {
  return all_of({plane(offset, {0, 0, 1}), sphere(offset + glm::dvec3(0, 0, 1), 1),
                 sphere(offset + glm::dvec3(-2, 1, 0.5), 0.5),
                 sphere(offset + glm::dvec3(2, 2, 1.5), 1.5)});
}

Camera above(Camera projection, const glm::dvec3& offset = glm::dvec3(0), double distance = 8) {
  return look_at(projection, offset + distance * glm::normalize(glm::dvec3(0.3, -1, 0.6)),
                 offset + glm::dvec3(0, 0, 0.5), {0, 0, 1});
}

/// Checks that the fit of a picture finds the camera it was taken with.
void expect_found(const Picture& picture, double tolerance_px, double tolerance_focal) {
  const auto fitted = fit_camera(picture.position, picture.valid, picture.window);
  ASSERT_TRUE(fitted);
  const Residual residual =
      measure_residual(*fitted, picture.position, picture.valid, picture.window);
  EXPECT_LT(residual.p99_px, tolerance_px);
  EXPECT_EQ(fitted->orthographic, picture.camera.orthographic);
  EXPECT_NEAR(fitted->fx / picture.camera.fx, 1, tolerance_focal);
  EXPECT_NEAR(fitted->fy / picture.camera.fy, 1, tolerance_focal);
  for (int i = 0; i < 9; ++i) {
    EXPECT_NEAR(fitted->rotation[i / 3][i % 3], picture.camera.rotation[i / 3][i % 3],
                tolerance_focal);
  }
}

TEST(CameraFit, FindsPerspectiveCameras) {
  for (const double fov : {1.0, 20.0, 58.0, 110.0, 150.0}) {
    SCOPED_TRACE(fov);
    const double distance = fov < 5 ? 200 : fov > 100 ? 3 : 8;
    expect_found(
        take_picture(still_life(), above(camera_from_fov(fov, kWindow, 1), {}, distance), kWindow),
        0.01, fov < 5 ? 2e-3 : 1e-4);
  }
}

TEST(CameraFit, FindsShiftedLensAndPixelAspect) {
  Camera camera = camera_from_fov(50, kWindow, 2.0);
  camera.cx += 31, camera.cy -= 17;
  expect_found(take_picture(still_life(), above(camera), kWindow), 0.01, 1e-4);
}

TEST(CameraFit, FindsCropsInDisplayPixels) {
  const Camera camera = above(camera_from_fov(50, kWindow, 1));
  const Window crop{40, 20, 150, 80};
  const auto fitted = fit_camera(take_picture(still_life(), camera, crop).position,
                                 take_picture(still_life(), camera, crop).valid, crop);
  ASSERT_TRUE(fitted);
  EXPECT_NEAR(fitted->cx, camera.cx, 0.01);
  EXPECT_NEAR(fitted->cy, camera.cy, 0.01);
}

TEST(CameraFit, FindsOrthographicCameras) {
  const Picture picture =
      take_picture(still_life(), above(camera_from_ortho_width(7, kWindow, 1)), kWindow);
  expect_found(picture, 0.01, 1e-4);
  const auto fitted = fit_camera(picture.position, picture.valid, kWindow);
  for (std::size_t i = 0; i < picture.position.size(); ++i) {
    if (picture.valid[i]) {
      EXPECT_LT(fitted->to_camera(glm::dvec3(picture.position[i])).z, 0)
          << "in front of the camera";
    }
  }
}

TEST(CameraFit, FindsCamerasOfLeftHandedWorlds) {
  Picture picture = take_picture(still_life(), above(camera_from_fov(50, kWindow, 1)), kWindow);
  for (glm::vec3& p : picture.position.pixels) p.y = -p.y;
  const auto fitted = fit_camera(picture.position, picture.valid, kWindow);
  ASSERT_TRUE(fitted);
  EXPECT_NEAR(glm::determinant(fitted->rotation), -1, 1e-6);
  EXPECT_LT(measure_residual(*fitted, picture.position, picture.valid, kWindow).p99_px, 0.01);
}

TEST(CameraFit, SurvivesAWorldOriginFarAway) {
  const glm::dvec3 offset(1e6, -2e6, 5e5);
  const Picture picture =
      take_picture(still_life(offset), above(camera_from_fov(50, kWindow, 1), offset), kWindow);
  const auto fitted = fit_camera(picture.position, picture.valid, kWindow);
  ASSERT_TRUE(fitted);
  // Float has steps of 1/8 here, several pixels each; the camera is found through their mean.
  EXPECT_NEAR(fitted->fx / picture.camera.fx, 1, 0.02);
}

TEST(CameraFit, SurvivesHalfPositionsAndAveragedSilhouettes) {
  Picture picture = take_picture(still_life(), above(camera_from_fov(50, kWindow, 1)), kWindow);
  std::mt19937 random(1);
  for (std::size_t i = 0; i < picture.position.size(); ++i) {
    for (int c = 0; c < 3; ++c) picture.position[i][c] = float(half(picture.position[i][c]));
    if (random() % 20 == 0) picture.position[i] *= 0.5f;  // half surface, half nothing
  }
  const auto fitted = fit_camera(picture.position, picture.valid, kWindow);
  ASSERT_TRUE(fitted);
  EXPECT_NEAR(fitted->fx / picture.camera.fx, 1, 1e-3);
  EXPECT_LT(measure_residual(*fitted, picture.position, picture.valid, kWindow).median_px, 0.2);
}

TEST(CameraFit, RefusesWhatDoesNotDetermineACamera) {
  const Camera camera = above(camera_from_fov(50, kWindow, 1));
  const Picture flat = take_picture(plane({}, {0, 0, 1}), camera, kWindow);
  EXPECT_FALSE(fit_camera(flat.position, flat.valid, kWindow)) << "one plane";

  Picture few = take_picture(still_life(), camera, kWindow);
  few.valid = Plane<unsigned char>(kWindow.width(), kWindow.height(), 0);
  EXPECT_FALSE(fit_camera(few.position, few.valid, kWindow)) << "no pixel";
  for (int i = 0; i < 5; ++i) few.valid(30 * i + 5, 17 * i + 5) = 1;
  EXPECT_FALSE(fit_camera(few.position, few.valid, kWindow)) << "five pixels";
}

TEST(CameraFit, RefusesAPlaneThatRoundingMadeThick) {
  const glm::dvec3 offset(3e5, -1e5, 2e5);
  const Camera camera = above(camera_from_fov(50, kWindow, 1), offset);
  const glm::dvec3 normal = glm::normalize(glm::dvec3(0.1, -0.2, 1));
  const Picture rounded = take_picture(plane(offset, normal), camera, kWindow);
  EXPECT_FALSE(fit_camera(rounded.position, rounded.valid, kWindow));
}

TEST(PoseFit, FindsThePoseOfAPlane) {
  const Camera projection = camera_from_fov(50, kWindow, 1);
  const Picture flat = take_picture(plane({}, {0, 0, 1}), above(projection), kWindow);
  const auto posed = fit_pose(projection, flat.position, flat.valid, kWindow);
  ASSERT_TRUE(posed);
  EXPECT_LT(measure_residual(*posed, flat.position, flat.valid, kWindow).p99_px, 0.01);
  EXPECT_NEAR(glm::distance(posed->origin, flat.camera.origin), 0, 1e-3);
}

TEST(PoseFit, KnowsCameraSpaceWithAnyAxes) {
  const Camera projection = camera_from_fov(50, kWindow, 1);
  Picture flat =
      take_picture(plane({0, 0, -5}, glm::normalize(glm::dvec3(0.2, 1, 0.4))), projection, kWindow);
  for (const glm::vec3& axes : {glm::vec3(1, 1, 1), glm::vec3(1, 1, -1)}) {
    Picture turned = flat;
    for (glm::vec3& p : turned.position.pixels) p *= axes;
    const auto posed = fit_pose(projection, turned.position, turned.valid, kWindow);
    ASSERT_TRUE(posed);
    EXPECT_TRUE(posed->is_camera_space(5));
  }
}

TEST(PoseFit, RefusesAProjectionThatCannotBe) {
  const Picture flat =
      take_picture(plane({}, {0, 0, 1}), above(camera_from_fov(50, kWindow, 1)), kWindow);
  EXPECT_FALSE(fit_pose(camera_from_fov(20, kWindow, 1), flat.position, flat.valid, kWindow));
}

/// A picture that shows a surface in some of its pixels only.
Picture with_pixels(Picture picture, const std::vector<glm::ivec2>& pixels) {
  Plane<unsigned char> valid(kWindow.width(), kWindow.height(), 0);
  for (const glm::ivec2& at : pixels) valid(at.x, at.y) = picture.valid(at.x, at.y);
  picture.valid = valid;
  return picture;
}

/// The angle between two cameras' axes, in radians.
double turn_between(const Camera& a, const Camera& b) {
  const glm::dmat3 turn = a.rotation * glm::transpose(b.rotation);
  return std::acos(std::clamp(0.5 * (turn[0][0] + turn[1][1] + turn[2][2] - 1), -1.0, 1.0));
}

TEST(PoseBeside, BringsFewPixelsToTheirPlaces) {
  Camera shifted = camera_from_fov(50, kWindow, 1);
  shifted.cx += 20, shifted.cy -= 9;
  std::vector<glm::ivec2> line;
  for (int x = 20; x < 140; ++x) line.emplace_back(x, 80);
  for (const Camera& lens : {shifted, camera_from_ortho_width(8, kWindow, 1)}) {
    const Camera beside = above(lens);
    for (const auto& pixels : {std::vector<glm::ivec2>{{80, 50}},
                               {{80, 50}, {60, 70}},
                               {{80, 50}, {60, 70}, {120, 60}},
                               line}) {
      SCOPED_TRACE(testing::Message() << lens.orthographic << " " << pixels.size());
      const Picture still = with_pixels(take_picture(still_life(), beside, kWindow), pixels);
      const auto same = fit_pose_near(beside, still.position, still.valid, kWindow);
      ASSERT_TRUE(same);
      EXPECT_LT(turn_between(*same, beside), 1e-5);
      Camera other =
          look_at(lens, beside.origin + glm::dvec3(0.2, 0.1, 0), {0.1, 0, 0.5}, {0, 0, 1});
      const Picture moved = with_pixels(take_picture(still_life(), other, kWindow), pixels);
      const auto found = fit_pose_near(beside, moved.position, moved.valid, kWindow);
      ASSERT_TRUE(found);
      EXPECT_LT(measure_residual(*found, moved.position, moved.valid, kWindow).max_px, 0.01);
      EXPECT_LT(turn_between(*found, other), 1.2 * turn_between(beside, other));
      EXPECT_EQ(found->orthographic, lens.orthographic);
      EXPECT_NEAR(found->fx / lens.fx, 1, 1e-12);
    }
  }
}

/// P lands some thousandths of a pixel from the middle of its own, as that of renderers does: three
/// pixels beside each other turned the camera by up to 9 degrees.
TEST(PoseBeside, OfPixelsThatTellLittleIsThatBeside) {
  const Camera beside = above(camera_from_fov(50, kWindow, 1));
  const Picture exact = take_picture(still_life(), beside, kWindow);
  std::mt19937 random(1);
  std::normal_distribution<double> off_px(0, 0.005);
  double most = 0;
  for (int i = 0; i < 200; ++i) {
    const glm::ivec2 at(10 + random() % 140, 30 + random() % 60);
    Picture picture = with_pixels(exact, {at, at + glm::ivec2(1, 0), at + glm::ivec2(0, 1)});
    for (glm::vec3& p : picture.position.pixels) {
      const double pixel = glm::distance(glm::dvec3(p), beside.origin) / beside.fx;
      p += glm::vec3(pixel * glm::dvec3(off_px(random), off_px(random), off_px(random)));
    }
    const auto found = fit_pose_near(beside, picture.position, picture.valid, kWindow);
    ASSERT_TRUE(found);
    most = std::max(most, turn_between(*found, beside));
  }
  EXPECT_LT(glm::degrees(most), 3);
}

/// A plane tells the pose under a known lens; from far away too, and of two that an orthographic
/// camera may have, it is the one nearer to the camera beside.
TEST(PoseBeside, OfAPlaneIsThatOfItsOwnPixels) {
  for (const Camera& lens :
       {camera_from_fov(50, kWindow, 1), camera_from_ortho_width(8, kWindow, 1)}) {
    const Picture flat = take_picture(plane({}, {0, 0, 1}), above(lens), kWindow);
    const Camera beside =
        look_at(lens, flat.camera.origin + glm::dvec3(1, 0.5, -0.3), {0.4, 0, 0.2}, {0, 0, 1});
    const auto found = fit_pose_near(beside, flat.position, flat.valid, kWindow);
    ASSERT_TRUE(found);
    EXPECT_LT(turn_between(*found, flat.camera), 1e-3) << lens.orthographic;
  }
}

TEST(PoseBeside, IsNoneWhereTheLensIsAnother) {
  const Picture flat =
      take_picture(plane({}, {0, 0, 1}), above(camera_from_fov(50, kWindow, 1)), kWindow);
  EXPECT_FALSE(
      fit_pose_near(above(camera_from_fov(20, kWindow, 1)), flat.position, flat.valid, kWindow));
}

/// Six pixels of a ball fit an orthographic camera that looks elsewhere; a hundred tell their own.
TEST(CameraFit, TakesNoOrthographicCameraThatFewPixelsLeaveOpen) {
  const Camera lens = camera_from_fov(50, kWindow, 1);
  std::vector<glm::ivec2> block;
  for (int i = 0; i < 6; ++i) block.emplace_back(78 + i % 3, 38 + i / 3);
  const Picture six = with_pixels(take_picture(still_life(), above(lens), kWindow), block);
  EXPECT_FALSE(fit_camera(six.position, six.valid, kWindow));
}

/// Averaged silhouettes lie on no surface, and tell nothing of how well the others agree.
TEST(CameraFit, TakesAnOrthographicCameraOfFewPixelsAmongSilhouettes) {
  const Picture all =
      take_picture(still_life(), above(camera_from_ortho_width(8, kWindow, 1)), kWindow);
  int found = 0;  // of eight random samples, of which some are too few
  for (unsigned seed = 1; seed <= 8; ++seed) {
    Picture few = all;
    std::mt19937 random(seed);
    for (std::size_t i = 0; i < few.valid.size(); ++i) {
      few.valid[i] &= random() % 30 == 0;
      if (random() % 10 == 0) few.position[i] *= 0.5f;  // half surface, half nothing
    }
    const auto fitted = fit_camera(few.position, few.valid, kWindow);
    if (!fitted) continue;
    ++found;
    EXPECT_TRUE(fitted->orthographic);
    EXPECT_LT(turn_between(*fitted, few.camera), 0.01);
  }
  EXPECT_GE(found, 6);
}

TEST(FitCamera, TheResidualIsThatOfAllPixels) {
  // A wall, with every position moved to the right: by 0 to 1 pixels, each amount once.
  const Camera camera = camera_from_fov(40, kWindow, 1);
  Plane<glm::vec3> positions(kWindow.width(), kWindow.height());
  const Plane<unsigned char> valid(kWindow.width(), kWindow.height(), 1);
  const std::size_t count = positions.size(), width = std::size_t(positions.width);
  for (std::size_t i = 0; i < count; ++i) {
    const double off = double(i * 7919 % count) / double(count);
    const glm::dvec2 at(double(i % width) + 0.5 + off, double(i / width) + 0.5);
    positions[i] = glm::vec3(camera.unproject(at, 10));
  }
  const Residual residual = measure_residual(camera, positions, valid, kWindow);
  EXPECT_NEAR(residual.median_px, 0.5, 1e-3);
  EXPECT_NEAR(residual.p99_px, 0.99, 1e-3);
  EXPECT_NEAR(residual.max_px, 1, 1e-3);
  EXPECT_NEAR(median_miss_px(camera, positions, valid, kWindow), residual.median_px, 1e-2);
}

}  // namespace
}  // namespace ssdo::test::fit_test
