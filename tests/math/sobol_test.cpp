// SPDX-License-Identifier: Apache-2.0
#include "math/sobol.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>

namespace ssdo::test::sobol_test {
namespace {

TEST(Sobol, EveryBoxOfEveryShapeHoldsOnePoint) {
  for (const std::uint32_t seed : {0u, 1u, 0xdeadbeefu}) {
    for (const std::uint32_t first : {0u, 64u, 192u}) {
      for (int wide = 1; wide <= 64; wide *= 2) {
        std::set<std::pair<int, int>> boxes;
        for (std::uint32_t i = first; i < first + 64; ++i) {
          const glm::vec2 p = sobol_point(i, seed);
          boxes.insert({int(p.x * float(wide)), int(p.y * float(64 / wide))});
        }
        EXPECT_EQ(boxes.size(), 64u) << "seed " << seed << ", boxes 1/" << wide << " wide";
      }
    }
  }
}

TEST(Sobol, SeedsAreIndependent) {
  // The mean over seeds of x y of the same point is that of independent numbers.
  double sum = 0;
  const int count = 1 << 14;
  for (int k = 0; k < count; ++k) {
    const glm::vec2 p = sobol_point(5, hash_of(std::uint32_t(k), 3, 0));
    sum += (p.x - 0.5) * (p.y - 0.5);
  }
  EXPECT_NEAR(sum / count, 0, 4 / 12.0 / std::sqrt(count));
}

}  // namespace
}  // namespace ssdo::test::sobol_test
