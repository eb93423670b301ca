// SPDX-License-Identifier: Apache-2.0
#include "estimators/view_space/view_planes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimators/view_space/ambient_light.h"
#include "support/analytic_scene.h"
#include "support/scene_of.h"

namespace ssdo::test::view_planes_test {
namespace {

const Window kWindow{0, 0, 37, 23};

Geometry sphere_over_nothing(const Camera& projection) {
  return geometry_of(sphere({0, 0, 0}, 1), look_at(projection, {0, 0, 4}, {0, 0, 0}, {0, 1, 0}),
                     kWindow);
}

TEST(ViewPlanes, DepthTimesRayIsThePosition) {
  Camera off_centre = camera_from_fov(40, kWindow, 2);
  off_centre.cx += 3, off_centre.cy -= 5;
  for (const Camera& projection : {off_centre, camera_from_ortho_width(4, kWindow, 1)}) {
    const Geometry g = sphere_over_nothing(projection);
    const ViewPlanes planes = make_view_planes(g);
    int surfaces = 0;
    for (int y = 0; y < 23; ++y) {
      for (int x = 0; x < 37; ++x) {
        const Surfel& s = g.surfaces(x, y);
        const float z = planes.z.row(y)[x];
        if (!s.is_surface()) {
          EXPECT_EQ(z, kBackgroundDepth);
          continue;
        }
        ++surfaces;
        const float w = planes.orthographic ? 1.0f : z;
        EXPECT_NEAR(planes.ray_x()[x] * w, s.position.x, 2e-6);
        EXPECT_NEAR(planes.ray_y()[y] * w, s.position.y, 2e-6);
        EXPECT_EQ(z, s.position.z);
      }
    }
    EXPECT_GT(surfaces, 50);
  }
}

TEST(ViewPlanes, ACropHasTheRaysOfTheWhole) {
  Geometry g = sphere_over_nothing(camera_from_fov(40, kWindow, 1));
  const ViewPlanes whole = make_view_planes(g);
  Geometry part = g;
  part.window = {5, 3, 37, 23};
  part.surfaces = Surfaces(32, 20);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 32; ++x) part.surfaces.set(x, y, g.surfaces(x + 5, y + 3));
  }
  const ViewPlanes cropped = make_view_planes(part);
  EXPECT_EQ(cropped.first_column, 5);
  EXPECT_EQ(cropped.first_row, 3);
  EXPECT_EQ(cropped.cx, whole.cx);
  for (int x = 0; x < 32; ++x) EXPECT_EQ(cropped.ray_x()[x], whole.ray_x()[x + 5]);
  for (int y = 0; y < 20; ++y) EXPECT_EQ(cropped.ray_y()[y], whole.ray_y()[y + 3]);
}

TEST(ViewPlanes, PaddingAndWhatIsBrokenAreBackground) {
  Geometry g = sphere_over_nothing(camera_from_fov(40, kWindow, 1));
  g.surfaces.position[0](18, 11) = NAN;
  g.surfaces.normal[1](19, 11) = INFINITY;
  g.surfaces.position[2](20, 11) = 1;
  const ViewPlanes planes = make_view_planes(g);
  for (const int x : {-PaddedLayout::kPad, -1, 18, 19, 20, 37, 37 + PaddedLayout::kPad - 1})
    EXPECT_EQ(planes.z.row(11)[x], kBackgroundDepth) << x;
  EXPECT_LT(planes.z.row(11)[17], 0);
  EXPECT_GT(planes.z.row(11)[17], kBackgroundDepth);
}

TEST(AmbientLight, IsAoTimesTheIrradianceOnTheNormalOrTheBentNormal) {
  Geometry g = sphere_over_nothing(camera_from_fov(40, kWindow, 1));
  const Plane<glm::vec3> none;
  const ParameterValues parameters;
  // Light from the upper half of the world alone: (1 + cos) / 2 of it arrives.
  auto map = std::make_shared<Plane<glm::vec3>>(64, 32);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 64; ++x) (*map)(x, y) = glm::vec3(2, 4, 6);
  }
  const Environment half(map, {});
  const Scene in = scene_of(g, half);
  const Plane<float> ao(37, 23, 0.5f);
  const Plane<glm::vec3> direct = ambient_light(in, ao);
  const Plane<glm::vec3> up(37, 23, glm::vec3(0, 1, 0)), unknown(37, 23, glm::vec3(0));
  const Plane<glm::vec3> lit_from_above = ambient_light(in, ao, &up);
  const Plane<glm::vec3> lit_by_normal = ambient_light(in, ao, &unknown);
  for (std::size_t i = 0; i < direct.size(); ++i) {
    if (!g.is_surface(i)) {
      EXPECT_EQ(direct[i], glm::vec3(0));
      continue;
    }
    const float expected = 0.5f * (1 + g.surfaces[i].normal.y) / 2;
    EXPECT_NEAR(direct[i].x, 2 * expected, 0.02);
    EXPECT_NEAR(direct[i].z, 6 * expected, 0.06);
    EXPECT_NEAR(lit_from_above[i].y, 4 * 0.5f, 0.04);
    EXPECT_EQ(lit_by_normal[i], direct[i]);
  }
  const Scene even = scene_of(g, Environment::constant(glm::vec3(1, 2, 3)));
  const Plane<glm::vec3> flat = ambient_light(even, ao);
  EXPECT_EQ(flat(18, 11), 0.5f * glm::vec3(1, 2, 3));
}

}  // namespace
}  // namespace ssdo::test::view_planes_test
