// SPDX-License-Identifier: Apache-2.0
//
// The small rules for numbers: which texts are one, which light is kept, and the sequences that
// samples come from.
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "math/light_range.h"
#include "math/luminance.h"
#include "math/number.h"
#include "math/plane.h"
#include "math/sequence_numbers.h"

namespace ssdo::test::numbers_test {
namespace {

TEST(ParseNumber, TakesFiniteNumbersAndNothingElse) {
  EXPECT_EQ(parse_number("-2.5e3"), -2500.0);
  EXPECT_EQ(parse_number("0"), 0.0);
  for (const char* text : {"", " 1", "1 ", "1,5", "0x10", "nan", "inf", "1e999", "1.5.2", "one"})
    EXPECT_EQ(parse_number(text), std::nullopt) << "'" << text << "'";
}

TEST(RangeOfLight, KeepsLightAndBoundsWhatLeavesTheRange) {
  const float inf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(within_range({0.5f, -2, 3e14f}), glm::vec3(0.5f, -2, 3e14f));
  EXPECT_EQ(within_range({inf, -inf, std::numeric_limits<float>::quiet_NaN()}),
            glm::vec3(kBrightest, -kBrightest, 0));
}

TEST(Luminance, OfWhiteIsOne) { EXPECT_NEAR(luminance(glm::vec3(1)), 1, 1e-6f); }

TEST(Window, EndsBeforeItsLastCoordinates) {
  const Window window{-2, 3, 4, 5};
  EXPECT_EQ(window.area(), 12u);
  EXPECT_TRUE(window.contains(-2, 3) && window.contains(3, 4));
  EXPECT_FALSE(window.contains(4, 4) || window.contains(3, 5) || window.contains(-3, 3));
}

TEST(SequenceNumbers, StepsAreThoseOfR2) {
  const double g = 1 / kR2First;
  EXPECT_NEAR(g * g * g, g + 1, 1e-14);
  EXPECT_NEAR(kR2Second, kR2First * kR2First, 1e-15);
  EXPECT_EQ(fraction(-0.25), 0.75);
}

TEST(SequenceNumbers, StartsOfNeighbouringSeedsFillTheUnitInterval) {
  std::set<int> tenths;
  double sum = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const double start = start_of(seed);
    ASSERT_TRUE(start >= 0 && start < 1);
    tenths.insert(int(10 * start));
    sum += start;
  }
  EXPECT_EQ(tenths.size(), 10u);
  EXPECT_NEAR(sum / 1000, 0.5, 0.03) << "three standard errors";
}

}  // namespace
}  // namespace ssdo::test::numbers_test
