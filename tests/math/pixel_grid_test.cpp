// SPDX-License-Identifier: Apache-2.0
#include "math/pixel_grid.h"

#include <gtest/gtest.h>

namespace ssdo::test::pixel_grid_test {
namespace {

TEST(PixelGrid, TakesAllOfAPicture) {
  const Window window{-3, 5, 20, 9};
  EXPECT_EQ(PixelGrid{}.of(window), window);
  EXPECT_FALSE(PixelGrid{}.is_coarse());
}

TEST(PixelGrid, TakesRowsThatThePictureHas) {
  const Window window{-3, 5, 20, 9};
  EXPECT_EQ((PixelGrid{.y0 = 6, .y1 = 8}.of(window)), (Window{-3, 6, 20, 8}));
  EXPECT_EQ((PixelGrid{.y0 = -9, .y1 = 7}.of(window)), (Window{-3, 5, 20, 7}));
  EXPECT_EQ((PixelGrid{.y0 = 30, .y1 = 40}.of(window)).area(), 0u);
}

/// Every pixel of the smaller picture is one of the large one, and no middle of a block is missed.
TEST(PixelGrid, TakesTheMiddleOfEveryBlockThatIsInThePicture) {
  for (const int stride : {3, 8}) {
    for (const int origin : {-5, 0, 2}) {
      const PixelGrid grid{.stride = stride, .origin_x = origin, .origin_y = origin + 1};
      const Window window{-7, -2, 30, 41}, small = grid.of(window);
      EXPECT_TRUE(window.contains(grid.middle_x(small.x0), grid.middle_y(small.y0)));
      EXPECT_TRUE(window.contains(grid.middle_x(small.x1 - 1), grid.middle_y(small.y1 - 1)));
      EXPECT_FALSE(window.contains(grid.middle_x(small.x0 - 1), 0));
      EXPECT_FALSE(window.contains(grid.middle_x(small.x1), 0));
      EXPECT_FALSE(window.contains(0, grid.middle_y(small.y0 - 1)));
      EXPECT_FALSE(window.contains(0, grid.middle_y(small.y1)));
    }
  }
}

}  // namespace
}  // namespace ssdo::test::pixel_grid_test
