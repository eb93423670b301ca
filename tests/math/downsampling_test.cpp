// SPDX-License-Identifier: Apache-2.0
#include "math/downsampling.h"

#include <gtest/gtest.h>

namespace ssdo::test::downsampling_test {
namespace {

TEST(Downsampling, KeepsTheCornerOfTheDisplayWindow) {
  const Downsampling half{2, {0, 0, 8, 6}};
  EXPECT_EQ(half.small(half.display), (Window{0, 0, 4, 3}));
  EXPECT_EQ(half.small({-3, -2, 9, 7}), (Window{-2, -1, 5, 4})) << "covered in part";
  EXPECT_EQ(half.large({-2, -1, 5, 4}), (Window{-4, -2, 10, 8}));
}

TEST(Downsampling, CountsFromADisplayWindowAnywhere) {
  const Downsampling third{3, {-10, 7, 2, 13}};
  const Window small = third.small(third.display);
  EXPECT_EQ(small, (Window{-4, 2, 0, 4}));
  EXPECT_EQ(third.large(small), third.display);
  EXPECT_EQ(third.small({-11, 7, 3, 14}), (Window{-5, 2, 1, 5}));
}

TEST(Downsampling, ByOneChangesNothing) {
  const Downsampling none{1, {3, -4, 9, 8}};
  EXPECT_TRUE(none.is_identity());
  EXPECT_EQ(none.small({-3, -7, 20, 10}), (Window{-3, -7, 20, 10}));
  EXPECT_EQ(none.reach(), 0);
}

}  // namespace
}  // namespace ssdo::test::downsampling_test
