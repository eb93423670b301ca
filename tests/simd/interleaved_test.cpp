// SPDX-License-Identifier: Apache-2.0
#include "simd/interleaved.h"

#include <gtest/gtest.h>

#include <set>

namespace ssdo::test::interleaved_test {
namespace {

constexpr int kPeriod = Interleaving::kPeriod, kPad = Interleaving::kPad;

TEST(Interleaving, RowsOfEveryEighthPixelHaveRoomForAVectorBeforeAndAfter) {
  for (const int width : {1, 127, 128, 1920, 3840}) {
    const Interleaving layout(width, 5, 3);
    std::set<std::ptrdiff_t> taken;
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < width; ++x) EXPECT_TRUE(taken.insert(layout.index(x, y)).second);
    // From the last entry of a row to the first of the next.
    for (int row = 0; row < 5 * kPeriod; ++row) {
      const int y = row / kPeriod, phase = row % kPeriod;
      for (int k = 1; k <= kPad; ++k) {
        EXPECT_FALSE(taken.contains(layout.index(y, phase, -k))) << width;
        EXPECT_FALSE(taken.contains(layout.index(y, phase, layout.columns() - 1 + k))) << width;
      }
    }
    EXPECT_GE(layout.index(0, 0, -kPad), 0);
    EXPECT_LT(layout.index(4, kPeriod - 1, layout.columns() - 1 + kPad),
              std::ptrdiff_t(layout.size()));
    EXPECT_EQ(layout.stride() / kPad % 2, 1) << "an odd number of cache lines";
  }
}

TEST(Interleaving, OneOfSoManyPixelsHasAPlaceOfItsOwn) {
  const Interleaving all(100, 7, 5);
  for (const int spacing : {1, 2, 4}) {
    const SparseInterleaving some(all, spacing);
    std::set<std::ptrdiff_t> taken;
    for (int y = spacing - 1; y < 7; y += spacing) {
      for (int phase = 0; phase < kPeriod; phase += spacing) {
        for (int column = 0; column < all.columns(); ++column)
          EXPECT_TRUE(taken.insert(some.index(y, phase, column)).second);
      }
    }
    EXPECT_GE(*taken.begin(), kPad) << "room for a vector before";
    EXPECT_LT(*taken.rbegin() + kPad, std::ptrdiff_t(some.size())) << "and after";
    EXPECT_LT(some.size(), all.size() / std::size_t(spacing * spacing) + all.size() / 7 + kPad);
  }
}

}  // namespace
}  // namespace ssdo::test::interleaved_test
