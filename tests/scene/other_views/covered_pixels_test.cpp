// SPDX-License-Identifier: Apache-2.0
#include "scene/other_views/covered_pixels.h"

#include <gtest/gtest.h>

#include "support/analytic_scene.h"

namespace ssdo::test::covered_pixels_test {
namespace {

constexpr Window kWindow{0, 0, 24, 16};
const Surface kWall = plane({0, 6, 0}, {0, -1, 0});

/// A wall, or the sky, behind a wire of one pixel's width.
class CoveredPixels : public testing::Test {
 protected:
  explicit CoveredPixels(bool has_wall = true) {
    const Camera by = look_at(camera_from_fov(50, kWindow, 1), {0, 0, 0}, {0, 1, 0}, {0, 0, 1});
    geometry_ = has_wall ? geometry_of(kWall, by, kWindow)
                         : geometry_of(sphere({0, -10, 0}, 1), by, kWindow);
    const Geometry near = geometry_of(plane({0, 3, 0}, {0, -1, 0}), by, kWindow);
    for (int y = 0; y < 16; ++y) geometry_.surfaces.set(12, y, near.surfaces(12, y));
  }

  Plane<unsigned char> covered(const Plane<float>& coverage) const {
    return covered_pixels(geometry_.surfaces, geometry_.camera, coverage);
  }

  Geometry geometry_;
  Plane<float> coverage_{24, 16, 0.0f};
};

class CoveredBeforeSky : public CoveredPixels {
 protected:
  CoveredBeforeSky() : CoveredPixels(false) {}
};

/// However little of its pixels a wire covers, they show it; those beside it do not.
TEST_F(CoveredPixels, AWireIsWhole) {
  for (int y = 0; y < 16; ++y) coverage_(11, y) = 0.6f, coverage_(12, y) = 0.1f;
  const Plane<unsigned char> found = covered(coverage_);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 24; ++x) ASSERT_EQ(found(x, y), x == 12) << x << " " << y;
}

/// Where nothing beside it is uncovered, all that shows may be hair.
TEST_F(CoveredPixels, HairIsWhole) {
  for (int y = 4; y < 12; ++y)
    for (int x = 2; x < 10; ++x) coverage_(x, y) = 0.2f;
  const Plane<unsigned char> found = covered(coverage_);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 24; ++x)
      ASSERT_EQ(found(x, y), x > 2 && x < 9 && y > 4 && y < 11) << x << " " << y;
}

/// An edge before the sky is the thing's, with no alpha to tell how much of it is sky.
TEST_F(CoveredBeforeSky, AnEdgeIsTheThings) {
  for (int y = 0; y < 16; ++y) coverage_(12, y) = 0.1f, coverage_(11, y) = 0.49f;
  for (int y = 0; y < 16; ++y) coverage_(13, y) = 0.5f;
  const Plane<unsigned char> found = covered(coverage_);
  for (int y = 0; y < 16; ++y) {
    EXPECT_EQ(found(12, y), 1) << "the rim is lost";
    EXPECT_EQ(found(11, y), 0) << "less than half of the sky";
    EXPECT_EQ(found(13, y), 1) << "half of the sky";
  }
}

/// Sums of ranks are rounded.
TEST_F(CoveredPixels, AllButARoundingIsAll) {
  coverage_(3, 3) = 0.992f, coverage_(6, 6) = 0.98f;
  const Plane<unsigned char> found = covered(coverage_);
  EXPECT_EQ(found(3, 3), 1);
  EXPECT_EQ(found(6, 6), 0) << "it lies on the wall around it";
}

}  // namespace
}  // namespace ssdo::test::covered_pixels_test
