// SPDX-License-Identifier: Apache-2.0
#include "io/pictures/primaries.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

namespace ssdo::test::primaries_test {
namespace {

constexpr Chromaticities kAp1 = {.713f, .293f, .165f, .830f, .128f, .044f, .32168f, .33767f};
constexpr Chromaticities kRec2020 = {.708f, .292f, .170f, .797f, .131f, .046f, .3127f, .3290f};

/// ITU-R BT.2087, and the matrix with Bradford adaptation that ACES transforms have for AP1.
TEST(Primaries, ConversionsArePublishedOnes) {
  const auto wide = conversion_of_primaries(kRec709, kRec2020);
  ASSERT_TRUE(wide);
  EXPECT_NEAR((*wide)[0].x, 0.6274, 1e-4);
  EXPECT_NEAR((*wide)[1].x, 0.3293, 1e-4);
  EXPECT_NEAR((*wide)[2].z, 0.8956, 1e-4);
  const auto aces = conversion_of_primaries(kAp1, kRec709);
  ASSERT_TRUE(aces);
  EXPECT_NEAR((*aces)[0].x, 1.70505, 1e-4);
  EXPECT_NEAR((*aces)[0].y, -0.13026, 1e-4);
  EXPECT_NEAR((*aces)[2].z, 1.15297, 1e-4);
}

TEST(Primaries, ThereAndBackIsNothing) {
  const glm::mat3 there = *conversion_of_primaries(kAp1, kRec709),
                  back = *conversion_of_primaries(kRec709, kAp1);
  const glm::vec3 color(0.2f, 0.7f, 3);
  EXPECT_LT(glm::distance(back * there * color, color), 1e-5);
  EXPECT_LT(glm::distance(there * glm::vec3(1), glm::vec3(1)), 1e-5) << "white stays white";
}

TEST(Primaries, SetsWithoutColoursHaveNoConversion) {
  for (const Chromaticities& none :
       {Chromaticities{}, Chromaticities{.3f, .3f, .4f, .4f, .5f, .5f, .3f, .3f},
        Chromaticities{.64f, .33f, .30f, .60f, .47f, .465f, .3127f, .329f},  // rounding off a line
        Chromaticities{.64f, .33f, .30f, .60f, .15f, .06f, .3127f, 0}}) {
    EXPECT_FALSE(conversion_of_primaries(none, kRec709));
    EXPECT_FALSE(conversion_of_primaries(kRec709, none));
  }
}

}  // namespace
}  // namespace ssdo::test::primaries_test
