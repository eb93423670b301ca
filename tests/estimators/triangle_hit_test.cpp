// SPDX-License-Identifier: Apache-2.0
#include "estimators/triangle_hit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "estimators/embree.h"

namespace ssdo::test::triangle_hit_test {
namespace {

const glm::vec3 kA(0, 0, 0), kB(4, 0, 0), kC(0, 4, 0);

RTCRay ray(const glm::vec3& origin, const glm::vec3& to) {
  RTCRay ray{};
  ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
  ray.dir_x = to.x, ray.dir_y = to.y, ray.dir_z = to.z;
  return ray;
}

TEST(TriangleHit, IsAtTheCornerThatCountsMost) {
  const auto corner = [](float x, float y) {
    return hit_of(ray({x, y, 2}, {0, 0, -1}), {}, {kA, kB, kC}).corner;
  };
  EXPECT_EQ(corner(0.5f, 0.5f), 0);
  EXPECT_EQ(corner(3, 0.5f), 1);
  EXPECT_EQ(corner(0.5f, 3), 2);
  // Of corners that count alike, the first.
  EXPECT_EQ(corner(2, 0), 0);
  EXPECT_EQ(corner(0, 2), 0);
  EXPECT_EQ(corner(2, 2), 1);
}

TEST(TriangleHit, IsWhereTheRayMeetsIt) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> any(-1, 1), share(0, 1);
  const auto point = [&] { return glm::vec3(any(random), any(random), any(random)); };
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 a = point(), b = point(), c = point(), origin = 5.0f * point();
    float u = share(random), v = share(random);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const glm::vec3 to = (1 - u - v) * a + u * b + v * c - origin;
    const double facing = std::abs(glm::dot(glm::normalize(to), glm::cross(b - a, c - a)));
    if (facing < 0.01) continue;
    const TriangleHit hit = hit_of(ray(origin, to), {}, {a, b, c});
    EXPECT_NEAR(hit.distance, 1, 1e-5 / facing) << i;
    const float w = 1 - u - v, most = std::max({u, v, w});
    EXPECT_GE((hit.corner == 0 ? w : hit.corner == 1 ? u : v), most - 1e-4 / facing) << i;
  }
}

/// Where rounding leaves nothing of the plane, the triangle is still between its corners.
TEST(TriangleHit, IsBetweenTheCornersOfATriangleSeenEdgeOn) {
  for (const float slope : {0.0f, 1e-38f, -1e-38f, 1e-20f, -1e-20f, 1e-7f, -1e-7f}) {
    for (const float above : {0.0f, 1e-30f, -1e-30f, 1e-3f, -1e-3f}) {
      const double distance = hit_of(ray({-2, 1, above}, {1, 0, slope}), {}, {kA, kB, kC}).distance;
      EXPECT_GE(distance, 2 - 1e-9) << slope << " " << above;
      EXPECT_LE(distance, 6 + 1e-9) << slope << " " << above;
    }
  }
  EXPECT_EQ(hit_of(ray({8, 1, 0}, {1, 0, 0}), {}, {kA, kB, kC}).distance, 0) << "it lies behind";
}

TEST(TriangleHit, HasADistanceWhateverTheTriangle) {
  for (const glm::vec3& b : {kA, kC, glm::vec3(0, 2, 0)}) {
    const TriangleHit hit = hit_of(ray({0, 1, 3}, {0, 0, -1}), {}, {kA, b, kC});
    EXPECT_EQ(hit.distance, 3);
    EXPECT_GE(hit.corner, 0);
    EXPECT_LE(hit.corner, 2);
  }
}

}  // namespace
}  // namespace ssdo::test::triangle_hit_test
