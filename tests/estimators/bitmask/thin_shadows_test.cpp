// SPDX-License-Identifier: Apache-2.0
//
// Shadows of a sun that are two pixels wide, under a slow pan: those that many rays of each pixel
// find are found by one.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "estimators/bitmask/request.h"
#include "scene/solids/solids.h"

namespace ssdo::test::thin_shadows_test {
namespace {

/// Where small squares float above a floor, z = 0.
std::vector<glm::dvec3> flakes() {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> x(-1.3, 1.3), y(-0.7, 0.7), z(0.25, 0.8);
  std::vector<glm::dvec3> middles(40);
  for (glm::dvec3& middle : middles)
    middle.x = x(random), middle.y = y(random), middle.z = z(random);
  return middles;
}

Surface floor_and_flakes(double half_width) {
  std::vector<Surface> surfaces = {plane({}, {0, 0, 1})};
  for (const glm::dvec3& middle : flakes()) {
    surfaces.push_back(cut(plane(middle, {0, 0, 1}), [=](const glm::dvec3& p) {
      return std::max(std::abs(p.x - middle.x), std::abs(p.y - middle.y)) < half_width;
    }));
  }
  return all_of(surfaces);
}

Plane<glm::vec3> direct(const Geometry& g, const Environment& environment, const Solids& solids,
                        int slices) {
  return run(g, {.radius = kNoLimit,
                 .environment = environment,
                 .products = {.ao = true, .direct = true},
                 .slices = slices,
                 .steps = 4,
                 .solids = &solids})
      .direct;
}

TEST(BitmaskSun, OneRayFindsShadowsOfTwoPixels) {
  const Window window{0, 0, 192, 108};
  const Camera still = tilted(camera_from_fov(40, window, 1), 35);
  const Surface scene = floor_and_flakes(6 / still.fx);
  auto map = std::make_shared<Plane<glm::vec3>>(512, 256, glm::vec3(0));
  (*map)(140, 60) = glm::vec3(32000);
  const Environment environment(map, {.up = UpAxis::z});
  double shadows = 0, found = 0;
  for (int frame = 0; frame < 3; ++frame) {
    Camera camera = still;
    camera.cx += 0.37 * frame, camera.cy += 0.21 * frame;
    const Geometry g = geometry_of(scene, camera, window);
    const Solids solids = guess_solids(g);
    const Plane<glm::vec3> by_many = direct(g, environment, solids, 8),
                           by_one = direct(g, environment, solids, 2);
    float lit = 0;
    for (const glm::vec3& light : by_many.pixels) lit = std::max(lit, light.x);
    for (std::size_t i = 0; i < by_many.size(); ++i) {
      if (by_many[i].x > 0.1f * lit) continue;
      shadows += 1;
      found += by_one[i].x < 0.5f * lit;
    }
  }
  fmt::print("shadows of two pixels: {:.3f} of {:.0f} pixels that are dark by many rays\n",
             found / shadows, shadows);
  EXPECT_GT(shadows, 300);
  EXPECT_GT(found / shadows, 0.98);
}

}  // namespace
}  // namespace ssdo::test::thin_shadows_test
