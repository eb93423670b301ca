// SPDX-License-Identifier: Apache-2.0
#include "scene/solids/connections.h"

#include <gtest/gtest.h>

#include "scene/same_surface.h"
#include "support/analytic_scene.h"
#include "support/boxes.h"

namespace ssdo::test::connections_test {
namespace {

/// No multiple of any vector's width.
const Window kWindow{0, 0, 83, 47};

TEST(Connections, AreThoseOfTheRule) {
  const Surface scene =
      all_of({cut(plane({}, {0, 0, 1}), [](auto& p) { return p.y < 0.8; }),
              Box{{-0.5, -0.5, 0}, {0.5, 0, 0.6}}.surface(), sphere({0.7, 0.2, 0.4}, 0.4)});
  for (const bool orthographic : {false, true}) {
    const Camera projection =
        orthographic ? camera_from_ortho_width(3, kWindow, 1) : camera_from_fov(40, kWindow, 1);
    const Geometry g = geometry_of(scene, look_at(projection, {0, -3, 2}, {}, {0, 0, 1}), kWindow);
    const PixelFootprint footprint(g.camera);
    const Plane<unsigned char> connections = find_connections(g);
    int connected = 0, apart = 0;
    for (int y = 0; y < kWindow.height(); ++y) {
      for (int x = 0; x < kWindow.width(); ++x) {
        EXPECT_EQ(bool(connections(x, y) & kShowsSurface), g.surfaces(x, y).is_surface());
        for (std::size_t k = 0; k < kDirections.size(); ++k) {
          const int other_x = x + kDirections[k].dx, other_y = y + kDirections[k].dy;
          const bool has_other = other_x >= 0 && other_x < kWindow.width() &&
                                 other_y < kWindow.height() && g.surfaces(x, y).is_surface() &&
                                 g.surfaces(other_x, other_y).is_surface();
          bool expected = false;
          if (has_other) {
            const Surfel &a = g.surfaces(x, y), &b = g.surfaces(other_x, other_y);
            expected = on_one_surface({a.position, a.normal}, {b.position, b.normal}, footprint);
            (expected ? connected : apart) += 1;
          }
          EXPECT_EQ(bool(connections(x, y) >> k & 1), expected) << x << " " << y << " " << k;
        }
      }
    }
    EXPECT_GT(connected, 5000);
    EXPECT_GT(apart, 100);
  }
}

TEST(Connections, ARidgeJoinsASideThatIsSeenEdgeOn) {
  // A pixel of the side is as deep as 12 of the front are wide.
  const Surface box = Box{{-1, -2, -2}, {0, 0, 2}}.surface();
  const Geometry g = geometry_of(box,
                                 look_at(camera_from_ortho_width(0.83, kWindow, 1), {0.253, -3, 0},
                                         {0.003, 0, 0}, {0.05, 0, 1}),
                                 kWindow);
  const Plane<unsigned char> connections = find_connections(g);
  int ridges = 0;
  for (int y = 0; y < kWindow.height(); ++y) {
    for (int x = 0; x + 1 < kWindow.width(); ++x) {
      if (!g.surfaces(x + 1, y).is_surface()) continue;
      EXPECT_TRUE(connections(x, y) & 1) << x << " " << y;
      ridges += g.surfaces(x, y).normal != g.surfaces(x + 1, y).normal;
    }
  }
  EXPECT_EQ(ridges, kWindow.height());
}

}  // namespace
}  // namespace ssdo::test::connections_test
