// SPDX-License-Identifier: Apache-2.0
#include "scene/objects/backdrop.h"

#include <gtest/gtest.h>

#include "support/analytic_scene.h"

namespace ssdo::test {
namespace {

constexpr Window kWindow{0, 0, 160, 90};

Camera camera(const glm::dvec3& target = {0, 2, 1}) {
  return look_at(camera_from_fov(55, kWindow, 1), {0.3, -6, 2.2}, target, {0, 0, 1});
}

const Surface kFloor = plane({0, 0, 0}, {0, 0, 1}), kBall = sphere({0.1, 0.6, 0.5}, 0.5),
              kStage = cut(kFloor, [](const glm::dvec3&p) { return glm::length(p) < 30; });

Geometry frame(const std::vector<Surface>& shown, const Camera& by = camera()) {
  return geometry_of(all_of(shown), by, kWindow);
}

TEST(Backdrop, ADomeIsFound) {
  for (const double radius : {150.0, 1000.0, 1e6}) {
    const Geometry with = frame({kStage, kBall, dome({0, 0, 0}, radius)}),
                   without = frame({kStage, kBall});
    const auto found = find_backdrop(with);
    ASSERT_TRUE(found) << radius;
    EXPECT_NEAR(found->radius, radius, 1e-3 * radius);
    double pixels = 0;
    for (std::size_t i = 0; i < found->coverage.size(); ++i) {
      EXPECT_EQ(found->coverage[i] > 0, !without.is_surface(i)) << i;
      pixels += double(found->coverage[i]);
    }
    EXPECT_NEAR(found->share, pixels / double(kWindow.area()), 1e-9);
  }
}

/// However much of the frame it covers, and wherever its middle is.
TEST(Backdrop, ADomeIsFoundWhereverTheCameraLooks) {
  for (const glm::dvec3& target : {glm::dvec3(0, 2, 8), {0, 2, -0.5}, {9, -6, 4}, {0.3, -5, 30}}) {
    const Geometry with = frame({kStage, kBall, dome({20, 30, -40}, 400)}, camera(target));
    EXPECT_TRUE(find_backdrop(with));
  }
}

TEST(Backdrop, OtherFarThingsAreNone) {
  const Surface wall = plane({0, 60, 0}, {0, -1, 0}), side = plane({-40, 0, 0}, {1, 0, 0}),
                other = plane({40, 0, 0}, {-1, 0, 0}), ceiling = plane({0, 0, 30}, {0, 0, -1});
  const std::vector<std::vector<Surface>> scenes = {
      {kFloor, kBall},
      {kStage, kBall},
      {kBall},
      {kFloor, kBall, wall},
      {kFloor, wall, side, other, ceiling},
      {kFloor, side},
      // Domes that the camera is not in, and one that is no larger than its scene.
      {kFloor, sphere({0, 300, 0}, 250)},
      {sphere({0, 500, 0}, 100)},
      {kStage, kBall, dome({0, 0, 0}, 31)},
  };
  for (std::size_t i = 0; i < scenes.size(); ++i)
    EXPECT_FALSE(find_backdrop(frame(scenes[i]))) << i;
  EXPECT_FALSE(find_backdrop(geometry_of(
      kFloor, look_at(camera_from_ortho_width(4, kWindow, 1), {0, -4, 2}, {0, 0, 0}, {0, 0, 1}),
      kWindow)));
}

}  // namespace
}  // namespace ssdo::test
