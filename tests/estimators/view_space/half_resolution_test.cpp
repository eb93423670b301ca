// SPDX-License-Identifier: Apache-2.0
#include "estimators/view_space/half_resolution.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimators/view_space/point_method_request.h"

namespace ssdo::test::half_resolution_test {
namespace {

/// Two planes that face the viewer, the right one nearer; edge in the picture's middle.
Geometry step(const Window& window, double near_depth) {
  Camera camera = camera_from_ortho_width(window.width(), window, 1);
  Geometry g;
  g.window = g.display = window;
  g.camera = camera;
  g.surfaces = Surfaces(window.width(), window.height());
  for (int y = 0; y < window.height(); ++y) {
    for (int x = 0; x < window.width(); ++x) {
      const double depth = x < window.width() / 2 ? 100 : near_depth;
      const glm::vec3 position(camera.unproject({x + 0.5, y + 0.5}, depth));
      g.surfaces.set(x, y, {position, {0, 0, 1}, 0});
    }
  }
  return g;
}

TEST(HalfResolution, TakesTheLowerRightOfEveryFourPixelsOfTheDisplayWindow) {
  Geometry g = step({0, 0, 21, 13}, 50);
  for (std::size_t i = 0; i < g.surfaces.size(); ++i) g.surfaces.rounding[i] = float(i);
  for (const int first : {0, 1, -3}) {
    g.display = {-first, -first, 30, 30};
    const ViewPlanes planes = make_view_planes(g);
    const HalfResolution half(planes);
    const ViewPlanes& r = half.receivers();
    for (int y = 0; y < r.height(); ++y) {
      for (int x = 0; x < r.width(); ++x) {
        // Of the pixels 2k and 2k + 1 of the display window, the second.
        const int k = int(std::floor(first / 2.0)) + x, l = int(std::floor(first / 2.0)) + y;
        const int column = std::min(2 * k + 1 - first, 20), row = std::min(2 * l + 1 - first, 12);
        ASSERT_GE(column, 0);
        EXPECT_EQ(half.surfels()(x, y).rounding, float(row * 21 + column));
        EXPECT_EQ(r.ray_x()[x], planes.ray_x()[column]);
        EXPECT_EQ(r.ray_y()[y], planes.ray_y()[row]);
        EXPECT_EQ(r.z.row(y)[x], planes.z.row(row)[column]);
      }
    }
  }
}

TEST(HalfResolution, AlongSurfacesNothingCrossesAnEdge) {
  const Geometry g = step({0, 0, 42, 10}, 50);
  const ViewPlanes planes = make_view_planes(g);
  const HalfResolution half(planes);
  Plane<float> values(half.receivers().width(), half.receivers().height());
  for (int y = 0; y < values.height; ++y) {
    for (int x = 0; x < values.width; ++x)
      values(x, y) = half.receivers().z.row(y)[x] < -75 ? 0.25f : 0.75f;
  }
  const Plane<float> along = half.upsample_along_surfaces(values),
                     bilinear = half.upsample_bilinear(values);
  int mixed = 0;
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 42; ++x) {
      EXPECT_EQ(along(x, y), x < 21 ? 0.25f : 0.75f) << x;
      mixed += bilinear(x, y) > 0.26f && bilinear(x, y) < 0.74f;
    }
  }
  EXPECT_GE(mixed, 20);
}

TEST(HalfResolution, OnOnePlaneBothAreBilinear) {
  const Window window{0, 0, 35, 27};
  const Geometry g =
      geometry_of(plane({}, {0, 0, 1}), tilted(camera_from_fov(40, window, 1), 70), window);
  const ViewPlanes planes = make_view_planes(g);
  const HalfResolution half(planes);
  Plane<float> values(half.receivers().width(), half.receivers().height());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = float(i * 37 % 11) / 11;
  const Plane<float> along = half.upsample_along_surfaces(values),
                     bilinear = half.upsample_bilinear(values);
  for (std::size_t i = 0; i < along.size(); ++i) EXPECT_NEAR(along[i], bilinear[i], 1e-5);
}

TEST(HalfResolution, APixelAloneOnItsSurfaceHasTheValueNearestInDepth) {
  Geometry g = step({0, 0, 8, 8}, 50);
  // One that no evaluated pixel shares: far behind the left plane's neighbours, nearer to it.
  g.surfaces.position[2](6, 6) = -90;
  g.surfaces.position[2](7, 7) = -91;
  const ViewPlanes planes = make_view_planes(g);
  const HalfResolution half(planes);
  Plane<float> values(4, 4, 0.2f);
  values(3, 3) = 0.6f;
  EXPECT_NEAR(half.upsample_along_surfaces(values)(6, 6), 0.6f, 1e-6);
}

TEST(HalfResolution, WorksForFramesOfOnePixel) {
  const Window one{0, 0, 1, 1};
  const Geometry g =
      geometry_of(plane({}, {0, 0, 1}), tilted(camera_from_fov(40, one, 1), 20), one);
  const ViewPlanes planes = make_view_planes(g);
  const HalfResolution half(planes);
  const Plane<float> value(1, 1, 0.5f);
  EXPECT_EQ(half.upsample_bilinear(value)[0], 0.5f);
  EXPECT_EQ(half.upsample_along_surfaces(value)[0], 0.5f);
}

}  // namespace
}  // namespace ssdo::test::half_resolution_test
