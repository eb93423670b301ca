// SPDX-License-Identifier: Apache-2.0
#include "math/pixel_grid.h"

#include <gtest/gtest.h>

#include "scene/camera/camera.h"

namespace ssdo::test {
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

/// A point that the large camera projects to the middle of a pixel that is taken, the small one
/// projects to the middle of the pixel that it becomes.
TEST(PixelGrid, ACameraOfItProjectsToItsPixels) {
  for (const int stride : {3, 8}) {
    const PixelGrid grid{.stride = stride, .origin_x = -4, .origin_y = 3};
    const Camera large = camera_from_fov(50, {0, 0, 200, 100}, 1), small = to_grid(large, grid);
    const auto pixel = [](const Camera& c, double x, double y) {
      return std::pair(c.cx + c.fx * x, c.cy - c.fy * y);
    };
    const double x = (grid.middle_x(7) + 0.5 - large.cx) / large.fx,
                 y = (large.cy - grid.middle_y(4) - 0.5) / large.fy;
    EXPECT_NEAR(pixel(small, x, y).first, 7.5, 1e-9);
    EXPECT_NEAR(pixel(small, x, y).second, 4.5, 1e-9);
    const Camera again = from_grid(small, grid);
    EXPECT_NEAR(again.fx, large.fx, 1e-9);
    EXPECT_NEAR(again.cx, large.cx, 1e-9);
    EXPECT_NEAR(again.cy, large.cy, 1e-9);
  }
}

}  // namespace
}  // namespace ssdo::test
