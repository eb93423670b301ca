// SPDX-License-Identifier: Apache-2.0
#include "estimators/view_space/half_ball.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

namespace ssdo::test::half_ball_test {
namespace {

TEST(HalfBall, EverySetHasAMeanCosineOfExactlyOneHalf) {
  for (const int count : {1, 2, 3, 16, 100}) {
    for (const auto& samples : half_ball_pattern(4, count, 7)) {
      ASSERT_EQ(samples.size(), std::size_t(count));
      double sum = 0;
      for (const HalfBallSample& s : samples) sum += s.direction.z;
      EXPECT_NEAR(sum / count, 0.5, 1e-7);
    }
  }
}

TEST(HalfBall, FillsTheVolumeEvenly) {
  // Moments of the uniform half-ball: E[r^3] = 1/2, E[r] = 3/4, E[x] = E[y] = 0, E[x^2] = 1/5.
  double r3 = 0, r1 = 0, count = 0;
  glm::dvec3 mean(0), squares(0);
  for (const auto& samples : half_ball_pattern(4, 64, 1)) {
    for (const HalfBallSample& s : samples) {
      EXPECT_NEAR(glm::length(s.direction), 1, 1e-6);
      EXPECT_GE(s.length, 0);
      EXPECT_LE(s.length, 1);
      const glm::dvec3 p = double(s.length) * glm::dvec3(s.direction);
      r1 += s.length, r3 += std::pow(s.length, 3), mean += p, squares += p * p, ++count;
    }
  }
  EXPECT_NEAR(r1 / count, 0.75, 2e-3);
  EXPECT_NEAR(r3 / count, 0.5, 2e-3);
  EXPECT_NEAR(mean.x / count, 0, 5e-3);
  EXPECT_NEAR(mean.y / count, 0, 5e-3);
  EXPECT_NEAR(mean.z / count, 3.0 / 8, 3e-3);
  EXPECT_NEAR(squares.x / count, 0.2, 5e-3);
}

TEST(HalfBall, SeedAndSetChangeThePoints) {
  const auto a = half_ball_pattern(4, 16, 1), b = half_ball_pattern(4, 16, 2);
  EXPECT_NE(a[0][0].direction, b[0][0].direction);
  EXPECT_NE(a[0][0].direction, a[1][0].direction);
}

}  // namespace
}  // namespace ssdo::test::half_ball_test
