// SPDX-License-Identifier: Apache-2.0
//
// The points and the noise of ssao and ssao-range, as the sources draw them.
#include "estimators/view_space/point_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "estimators/view_space/slow_point_kernel.h"

namespace ssdo::test::point_kernel_test {
namespace {

TEST(PointKernel, IsTheSourcesLoop) {
  for (const unsigned seed : {0u, 3u, 1001u}) {
    for (const bool random_factor : {false, true}) {
      for (const double least : {0.1, 0.01}) {
        const auto points = point_kernel(64, float(least), random_factor, seed);
        const auto slow = slow_point_kernel(64, least, random_factor, seed);
        ASSERT_EQ(points.size(), slow.size());
        for (std::size_t i = 0; i < slow.size(); ++i)
          EXPECT_LT(glm::length(glm::dvec3(points[i]) - slow[i]), 1e-6) << i;
      }
    }
  }
}

/// Means over the directions of a box of 2 x 2 x 1 about its centre's foot, by a sum over the box.
struct BoxMeans {
  double z = 0, z2 = 0, x2 = 0;
  BoxMeans() {
    constexpr int n = 100;
    for (int i = 0; i < n * n * n; ++i) {
      const glm::dvec3 v((i % n + 0.5) / n * 2 - 1, (i / n % n + 0.5) / n * 2 - 1,
                         (i / n / n + 0.5) / n);
      const glm::dvec3 d = glm::normalize(v);
      z += d.z / (n * n * n), z2 += d.z * d.z / (n * n * n), x2 += d.x * d.x / (n * n * n);
    }
  }
};

TEST(PointKernel, HasTheDirectionsOfTheBoxAndTheLengthsOfTheSquare) {
  const BoxMeans expected;
  constexpr int kCount = 64, kSeeds = 2000;
  for (const bool random_factor : {false, true}) {
    const double least = random_factor ? 0.1 : 0.01;
    double x = 0, z = 0, z2 = 0, x2 = 0, factor = 0, factor2 = 0;
    for (unsigned seed = 0; seed < kSeeds; ++seed) {
      const auto points = point_kernel(kCount, float(least), random_factor, seed);
      for (int i = 0; i < kCount; ++i) {
        const glm::dvec3 v(points[std::size_t(i)]);
        const double length = glm::length(v), share = double(i) / kCount,
                     longest = least + (1 - least) * share * share;
        ASSERT_GE(v.z, 0);
        ASSERT_LE(length, longest * 1.00001);
        constexpr double kEach = 1.0 / (kCount * kSeeds);
        factor += kEach * length / longest, factor2 += kEach * std::pow(length / longest, 2);
        x += kEach * v.x / length, x2 += kEach * v.x * v.x / (length * length);
        z += kEach * v.z / length, z2 += kEach * v.z * v.z / (length * length);
      }
    }
    EXPECT_NEAR(x, 0, 0.005);
    EXPECT_NEAR(z, expected.z, 0.005);
    EXPECT_NEAR(z2, expected.z2, 0.005);
    EXPECT_NEAR(x2, expected.x2, 0.005);
    EXPECT_NEAR(factor, random_factor ? 0.5 : 1, 0.005);
    EXPECT_NEAR(factor2, random_factor ? 1.0 / 3 : 1, 0.005);
  }
}

TEST(PointKernel, TheNoiseFillsASquareInThePicturesPlane) {
  constexpr int kSeeds = 4000;
  double x = 0, y = 0, x2 = 0, y2 = 0, xy = 0, beside = 0;
  std::set<float> drawn;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const auto noise = frame_noise(seed);
    for (std::size_t i = 0; i < noise.size(); ++i) {
      const glm::vec3& v = noise[i];
      ASSERT_EQ(v.z, 0);
      ASSERT_TRUE(std::abs(v.x) <= 1 && std::abs(v.y) <= 1);
      constexpr double kEach = 1.0 / (16 * kSeeds);
      x += kEach * v.x, y += kEach * v.y, xy += kEach * v.x * v.y;
      x2 += kEach * v.x * v.x, y2 += kEach * v.y * v.y;
      beside += kEach * v.x * noise[(i + 1) % 16].x;
      drawn.insert(v.x);
    }
  }
  for (const double mean : {x, y, xy, beside}) EXPECT_NEAR(mean, 0, 0.01);
  for (const double square : {x2, y2}) EXPECT_NEAR(square, 1.0 / 3, 0.01);
  EXPECT_GT(drawn.size(), std::size_t(16 * kSeeds * 0.99)) << "no seed repeats another's";
}

TEST(PointKernel, StaysWhenTheNoiseOrTheCountChanges) {
  const auto few = point_kernel(4, 1, false, 1), many = point_kernel(64, 1, false, 1);
  for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i], many[i]);
  EXPECT_NE(point_kernel(4, 0.1f, true, 1)[0], point_kernel(4, 0.1f, true, 2)[0]);
}

}  // namespace
}  // namespace ssdo::test::point_kernel_test
