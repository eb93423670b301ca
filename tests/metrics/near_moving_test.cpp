// SPDX-License-Identifier: Apache-2.0
#include "metrics/near_moving.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "support/analytic_scene.h"

namespace ssdo::test::near_moving_test {
namespace {

const Window kWindow{0, 0, 160, 96};

Camera camera_at(double degrees) {
  const double a = degrees * std::numbers::pi / 180;
  return look_at(camera_from_fov(45, kWindow, 1), {5 * std::sin(a), -5 * std::cos(a), 2},
                 {0, 0, 0.4}, {0, 0, 1});
}

Geometry frame_with(const glm::dvec3& ball, double degrees) {
  return geometry_of(all_of({plane({}, {0, 0, 1}), plane({0, 3, 0}, {0, -1, 0}),
                             sphere({1.4, 0.4, 0.5}, 0.5), sphere(ball, 0.3)}),
                     camera_at(degrees), kWindow);
}

/// A post of half a pixel, which falls between pixels.
Geometry frame_with_a_post(double degrees) {
  const Surface post = cut(plane({0, 0.2, 0}, {0, -1, 0}), [](const glm::dvec3& p) {
    return std::abs(p.x - 0.3) < 0.006 && p.z < 1.5;
  });
  return geometry_of(all_of({plane({}, {0, 0, 1}), post}), camera_at(degrees), kWindow);
}

/// Those within kNearMoving + more pixels of where one of both places of a ball is seen.
Plane<unsigned char> around(const Camera& camera, const std::vector<glm::dvec3>& balls, int more) {
  Plane<unsigned char> near(kWindow.width(), kWindow.height(), 0);
  for (const glm::dvec3& ball : balls) {
    for (int y = 0; y < near.height; ++y) {
      for (int x = 0; x < near.width; ++x) {
        const glm::dvec3 p = camera.to_camera(ball);
        const glm::dvec2 off = glm::dvec2(x + 0.5, y + 0.5) - camera.project(p);
        // The silhouette of a small ball is about a disk.
        const double reach = 0.3 / -p.z * camera.fx + kNearMoving + more;
        if (std::max(std::abs(off.x), std::abs(off.y)) <= reach) near(x, y) = 1;
      }
    }
  }
  return near;
}

TEST(NearMoving, IsAroundBothPlacesOfABall) {
  const glm::dvec3 then(-1.7, 0, 0.3), now(-0.9, 0, 0.3);
  for (const double degrees : {0.0, 2.0}) {
    const Plane<unsigned char> near = near_moving(frame_with(then, 0), frame_with(now, degrees));
    const Plane<unsigned char> most = around(camera_at(degrees), {then, now}, 2),
                               least = around(camera_at(degrees), {then, now}, -3);
    int inside = 0;
    for (std::size_t i = 0; i < near.size(); ++i) {
      EXPECT_LE(near[i], most[i]) << i % 160 << " " << i / 160;
      EXPECT_GE(near[i], least[i]) << i % 160 << " " << i / 160;
      inside += near[i];
    }
    EXPECT_LT(inside, 0.7 * double(near.size())) << "the other ball is still";
  }
}

TEST(NearMoving, NothingIsInAStillScene) {
  const glm::dvec3 ball(-0.9, 0, 0.3);
  for (const double degrees : {0.0, 0.3, 1.0, 3.0, 8.0}) {
    const Plane<unsigned char> near = near_moving(frame_with(ball, 0), frame_with(ball, degrees));
    EXPECT_EQ(std::ranges::count(near.pixels, 1), 0) << degrees;
    const Plane<unsigned char> near_post =
        near_moving(frame_with_a_post(0), frame_with_a_post(degrees));
    EXPECT_EQ(std::ranges::count(near_post.pixels, 1), 0) << degrees;
  }
}

}  // namespace
}  // namespace ssdo::test::near_moving_test
