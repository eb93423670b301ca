// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "math/pixel_grid.h"
#include "scene/camera/camera.h"

namespace ssdo::test::coarse_camera_test {
namespace {

/// A point that the large camera projects to the middle of a pixel that is taken, the small one
/// projects to the middle of the pixel that it becomes.
TEST(CoarseCamera, ProjectsToPixelsOfItsGrid) {
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
}  // namespace ssdo::test::coarse_camera_test
