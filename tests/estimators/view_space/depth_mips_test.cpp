// SPDX-License-Identifier: Apache-2.0
#include "estimators/view_space/depth_mips.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "estimators/view_space/slow_depth_mips.h"

namespace ssdo::test::depth_mips_test {
namespace {

/// Depths that are all different, some of them background.
Geometry noise(const Window& window, const Window& display) {
  std::mt19937 random(7);
  Geometry g;
  g.window = window, g.display = display;
  g.surfaces = Surfaces(window.width(), window.height());
  g.surfaces.change_each([&](Surfel& s) {
    if (random() % 8 == 0) return;
    s = {{0, 0, -1 - 1e-6f * float(random() % 1000000)}, {0, 0, 1}, 0};
  });
  return g;
}

int floor_half(int i, int times) { return int(std::floor(double(i) / (1 << times))); }

TEST(DepthMips, EveryLevelIsThePapersRecursion) {
  const Window display{-3, 5, 1000, 1000};
  for (const Window& window :
       {Window{-3, 5, 74, 50}, Window{40, 30, 117, 74}, Window{-50, -38, 21, 14},
        Window{-3, 5, -2, 6}, Window{9, 9, 10, 60}, Window{9, 9, 90, 10}}) {
    const Geometry g = noise(window, display);
    const DepthMips mips(make_view_planes(g));
    int levels_that_differ = 0;
    for (int level = 0; level <= DepthMips::kCoarsest; ++level) {
      bool differs = false;
      for (int y = 0; y < window.height(); ++y) {
        for (int x = 0; x < window.width(); ++x) {
          const int column = x + window.x0 - display.x0, row = y + window.y0 - display.y0;
          ASSERT_EQ(mips.at(level, x, y),
                    slow_mip(g, level, floor_half(column, level), floor_half(row, level)))
              << level << ": " << x << "," << y;
          differs |= mips.at(level, x, y) != mips.at(0, x, y);
        }
      }
      levels_that_differ += differs;
    }
    EXPECT_EQ(levels_that_differ, window.area() > 1 ? DepthMips::kCoarsest : 0);
  }
}

TEST(DepthMips, AnIndexFromTheLevelFindsTheSame) {
  const Geometry g = noise({10, 20, 100, 90}, {0, 0, 200, 200});
  const DepthMips mips(make_view_planes(g));
  for (int level = 0; level <= DepthMips::kCoarsest; ++level) {
    const int start = mips.twice_rows() - (mips.twice_rows() >> level);
    EXPECT_EQ(mips.data()[(start + ((31 + mips.top()) >> level)) * mips.stride() +
                          ((57 + mips.left()) >> level)],
              mips.at(level, 57, 31));
  }
}

TEST(DepthMips, ACropHasTheSameLevelsWhereItHasTheirPixels) {
  const Window all{0, 0, 300, 200}, part{37, 21, 290, 190};
  const Geometry whole = noise(all, all);
  Geometry cropped = noise(part, all);
  for (int y = 0; y < part.height(); ++y) {
    for (int x = 0; x < part.width(); ++x)
      cropped.surfaces.set(x, y, whole.surfaces(x + part.x0, y + part.y0));
  }
  const DepthMips of_whole(make_view_planes(whole)), of_part(make_view_planes(cropped));
  const int margin = 1 << DepthMips::kCoarsest;
  for (int level = 0; level <= DepthMips::kCoarsest; ++level) {
    for (int y = margin; y < part.height() - margin; ++y) {
      for (int x = margin; x < part.width() - margin; ++x)
        ASSERT_EQ(of_part.at(level, x, y), of_whole.at(level, x + part.x0, y + part.y0)) << level;
    }
  }
}

}  // namespace
}  // namespace ssdo::test::depth_mips_test
