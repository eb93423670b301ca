// SPDX-License-Identifier: Apache-2.0
//
// Where the rays of a pixel start: what a pixel shows is seen, so that the way to the viewer is
// open.
#include "estimators/trace/ray_origin.h"

#include <gtest/gtest.h>

#include "estimators/ray_start.h"
#include "estimators/trace_request.h"
#include "scene/normals/normals.h"
#include "scene/pixel_footprint.h"

namespace ssdo::test::ray_origin_test {
namespace {

/// A floor, and a wall that leans over it by 30 degrees from y = 0 up.
Surface floor_under_a_leaning_wall() {
  const double tilt = glm::radians(30.0);
  return all_of({cut(plane({}, {0, 0, 1}), [](const glm::dvec3& p) { return p.y < 0; }),
                 cut(plane({}, {0, -std::cos(tilt), -std::sin(tilt)}),
                     [](const glm::dvec3& p) { return p.z > 0; })});
}

const Window kWindow{0, 0, 96, 72};

/// The foot of the wall crosses the rows of its picture.
Camera low_camera(bool orthographic) {
  return look_at(
      orthographic ? camera_from_ortho_width(2, kWindow, 1) : camera_from_fov(20, kWindow, 1),
      {1.5, -5.6, 2}, {0, 0, 0}, {0, 0, 1});
}

/// Pixels whose way to the viewer is closed, from above the surface and from where rays start.
struct Closed {
  int above = 0, start = 0;
};

Closed closed_ways(const Geometry& g) {
  const RayScene rays(build_height_field(g, {}));
  const PixelFootprint footprints(g.camera);
  Closed closed;
  for (const Surfel& s : g.surfaces) {
    if (!s.is_usable()) continue;
    const glm::vec3 view = direction_to_viewer(s.position, g.camera.orthographic);
    const float footprint = footprints.at(-s.position.z);
    const glm::dvec3 above = s.position + kAboveFootprints * footprint * s.normal;
    closed.above += rays.is_blocked(above, view, kNoLimit);
    closed.start +=
        rays.is_blocked(ray_origin(rays, s, {s.normal, view, footprint}), view, kNoLimit);
  }
  return closed;
}

TEST(RayOrigin, SeesTheViewerUnderALeaningWall) {
  for (const bool orthographic : {false, true}) {
    const Closed closed =
        closed_ways(geometry_of(floor_under_a_leaning_wall(), low_camera(orthographic), kWindow));
    EXPECT_GT(closed.above, 10) << "triangles lean over the last pixels of the floor";
    EXPECT_EQ(closed.start, 0) << "orthographic " << orthographic;
  }
}

/// In the edge between two walls, seen along it by the pixels of the diagonal: a step along the
/// normal of one wall stays on the other, where rounding decides what is hidden. Half is open, of
/// which the triangle across the edge hides half.
TEST(RayOrigin, InTheEdgeOfTwoWallsSomeIsOpen) {
  const Surface walls = all_of({plane({-1, 0, 0}, {1, 0, 0}), plane({0, 1, 0}, {0, -1, 0})});
  const Window window{0, 0, 48, 48};
  for (const double fov : {40.0, 60.0, 80.0}) {
    const Geometry g = geometry_of(walls, camera_from_fov(fov, window, 1), window);
    const Products out = run_trace(g, {.radius = 1e-2f});
    for (int i = 2; i < 20; ++i) EXPECT_NEAR(out.ao(i, i), 0.25, 0.05) << fov << " " << i;
  }
}

}  // namespace
}  // namespace ssdo::test::ray_origin_test
