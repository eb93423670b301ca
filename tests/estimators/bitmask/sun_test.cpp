// SPDX-License-Identifier: Apache-2.0
//
// The shadow of a sun against rays to it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <memory>

#include "estimators/bitmask/request.h"
#include "scene/solids.h"

namespace ssdo::test {
namespace {

/// Black but for one texel.
Environment one_sun() {
  auto map = std::make_shared<Plane<glm::vec3>>(256, 128, glm::vec3(0));
  (*map)(70, 30) = glm::vec3(8000);
  return Environment(map, {});
}

/// Share of the pixels that have the sun where rays do not, or the other way round.
double share_that_differs(const Surface& scene, const Camera& camera, const Window& window) {
  const Geometry g = geometry_of(scene, camera, window);
  const Solids solids = guess_solids(g);
  const Environment environment = one_sun();
  const Light light = model_light(environment, g.world_to_camera);
  EXPECT_EQ(light.suns.size(), 1u);
  const glm::dvec3 to_sun =
      glm::transpose(camera.rotation) * glm::dvec3(light.suns.at(0).direction);
  const Products out = run(g, {.radius = kNoLimit,
                               .environment = environment,
                               .products = {.ao = true, .direct = true},
                               .slices = 2,
                               .steps = 200,
                               .solids = &solids});
  double differs = 0, shadows = 0;
  for (int y = 0; y < window.height(); ++y) {
    for (int x = 0; x < window.width(); ++x) {
      const Point p = point_at(scene, camera, window, x, y);
      const double cosine = glm::dot(p.normal, to_sun);
      const bool lit = cosine > 0 && !scene({p.position + 1e-6 * p.normal, to_sun});
      const double unoccluded = std::max(cosine, 0.0) * light.suns[0].irradiance.x;
      differs += std::abs(out.direct(x, y).x - (lit ? unoccluded : 0)) > 0.5 * unoccluded;
      shadows += cosine > 0 && !lit;
    }
  }
  const double pixels = window.width() * window.height();
  EXPECT_GT(shadows / pixels, 0.03) << "there is a shadow to be seen";
  return differs / pixels;
}

TEST(BitmaskSun, CastsTheShadowThatRaysSee) {
  const Window window{0, 0, 192, 144};
  const Surface ball = all_of({plane({}, {0, 0, 1}), sphere({0, 0, 0.5}, 0.5)});
  for (const Camera& projection :
       {camera_from_fov(40, window, 1), camera_from_ortho_width(4, window, 1)}) {
    const double off = share_that_differs(ball, tilted(projection, 50), window);
    fmt::print("shadow of a ball, {}: {:.2f} % of pixels off\n",
               projection.orthographic ? "ortho" : "persp", 100 * off);
    EXPECT_LT(off, 0.03);
  }
}

TEST(BitmaskSun, WhatGoesOnBeyondTheFrameIsNotDrawnAcrossIt) {
  // A fence that the frame cuts off, before a sun that stands 60 degrees above it.
  const Window window{0, 0, 192, 144};
  const Surface fence = cut(plane({0, 1, 0}, {0, -1, 0}), [](const glm::dvec3& p) {
    return p.z > 0 && p.x / 0.2 - std::floor(p.x / 0.2) < 0.5;
  });
  const Surface scene = all_of({plane({}, {0, 0, 1}), fence});
  const Camera camera =
      look_at(camera_from_fov(40, window, 1), {0, -3, 1.5}, {0, 0, 0.3}, {0, 0, 1});
  const Geometry g = geometry_of(scene, camera, window);
  const Solids solids = guess_solids(g);
  auto map = std::make_shared<Plane<glm::vec3>>(256, 128, glm::vec3(0));
  (*map)(64, 21) = glm::vec3(8000);
  EnvironmentFrame frame;
  frame.up = UpAxis::z;
  const Products out = run(g, {.radius = kNoLimit,
                               .environment = Environment(map, frame),
                               .products = {.ao = true, .direct = true},
                               .slices = 2,
                               .steps = 64,
                               .solids = &solids});
  // On the floor, where the way to the sun passes the fence up to 17 cm above the frame's upper
  // edge.
  float most = 0;
  for (const glm::vec3& light : out.direct.pixels) most = std::max(most, light.x);
  double pixels = 0, least = 1, mean = 0;
  for (int y = 0; y < window.height(); ++y) {
    for (int x = 40; x < 152; ++x) {
      const Point p = point_at(scene, camera, window, x, y);
      if (p.normal.z < 0.5 || p.position.y < 0.3 || p.position.y > 0.4) continue;
      const double seen = out.direct(x, y).x / most;
      pixels += 1, mean += seen, least = std::min(least, seen);
    }
  }
  fmt::print("beyond the frame: {:.2f} of a sun, at least {:.2f}\n", mean / pixels, least);
  EXPECT_GT(pixels, 200);
  EXPECT_LT(mean / pixels, 0.97);
  EXPECT_GT(least, 0.6) << "the shadow of a slat";
}

}  // namespace
}  // namespace ssdo::test
