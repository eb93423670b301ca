// SPDX-License-Identifier: Apache-2.0
//
// How a march is told what pixels show.
#include "estimators/bitmask/march_scene.h"

#include <gtest/gtest.h>

#include "scene/solids/solids.h"
#include "support/analytic_scene.h"

namespace ssdo::test::march_scene_test {
namespace {

/// The normals beside the frame are made from what marches read of the tangent planes.
TEST(MarchScene, TiltsAreTheNormalsOfSurfaces) {
  const Window window{0, 0, 64, 48};
  const glm::dvec3 normals[] = {{0, 0, 1}, {0.6, 0, 0.8}, {-0.48, 0.6, 0.64}, {0, 0.995, 0.0999}};
  for (const glm::dvec3& normal : normals) {
    for (const bool orthographic : {false, true}) {
      const Camera camera =
          orthographic ? camera_from_ortho_width(2, window, 1.5) : camera_from_fov(50, window, 1.5);
      const Geometry g = geometry_of(plane({0, 0, -9}, normal), camera, window);
      const MarchScene scene = make_march_scene(g, constant_thickness(g, 1), {});
      int seen = 0;
      for (std::size_t i = 0; i < scene.border_depth.size(); ++i) {
        if (!holds_solid(scene.border_depth[i]) || scene.border_depth[i] == 0) continue;
        ++seen;
        for (int c = 0; c < 3; ++c)
          ASSERT_NEAR(scene.border_normal[c][i], glm::normalize(normal)[c], 2e-5);
      }
      EXPECT_GT(seen, 60);
    }
  }
}

}  // namespace
}  // namespace ssdo::test::march_scene_test
