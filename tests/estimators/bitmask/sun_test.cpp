// SPDX-License-Identifier: Apache-2.0
//
// The shadow of a sun against rays to it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "estimators/bitmask/request.h"
#include "scene/solids/solids.h"
#include "support/boxes.h"
#include "support/sun_of.h"

namespace ssdo::test::sun_test {
namespace {

/// Black but for one texel.
Environment one_sun(int x = 70, int y = 30, const EnvironmentFrame& frame = {}) {
  auto map = std::make_shared<Plane<glm::vec3>>(256, 128, glm::vec3(0));
  (*map)(x, y) = glm::vec3(8000);
  return Environment(map, frame);
}

/// Shares of the pixels: that have the sun where rays do not, or the other way round; and those of
/// the lit and of the dark pixels that a sun would reach.
struct Differs {
  double all = 0, of_lit = 0, of_dark = 0;
};

Differs shares_that_differ(const Surface& scene, const Camera& camera, const Window& window,
                           const Environment& environment = one_sun()) {
  const Geometry g = geometry_of(scene, camera, window);
  const Solids solids = guess_solids(g);
  const Light light = model_light(environment, g.world_to_camera);
  EXPECT_EQ(light.sources.size(), 1u);
  const glm::dvec3 to_sun = glm::transpose(camera.rotation) * glm::dvec3(sun_of(light).direction);
  const Products out = run(g, {.radius = kNoLimit,
                               .environment = environment,
                               .products = {.ao = true, .direct = true},
                               .slices = 2,
                               .steps = 200,
                               .solids = &solids});
  Differs differs;
  double lit_pixels = 0, shadows = 0;
  for (int y = 0; y < window.height(); ++y) {
    for (int x = 0; x < window.width(); ++x) {
      const Point p = point_at(scene, camera, window, x, y);
      const double cosine = glm::dot(p.normal, to_sun);
      const bool lit = cosine > 0 && !scene({p.position + 1e-6 * p.normal, to_sun});
      const double unoccluded = std::max(cosine, 0.0) * sun_of(light).irradiance.x;
      const bool off = std::abs(out.direct(x, y).x - (lit ? unoccluded : 0)) > 0.5 * unoccluded;
      differs.all += off, (lit ? differs.of_lit : differs.of_dark) += off;
      lit_pixels += lit, shadows += cosine > 0 && !lit;
    }
  }
  const double pixels = window.width() * window.height();
  EXPECT_GT(shadows / pixels, 0.03) << "there is a shadow to be seen";
  return {differs.all / pixels, differs.of_lit / lit_pixels, differs.of_dark / shadows};
}

TEST(BitmaskSun, CastsTheShadowThatRaysSee) {
  const Window window{0, 0, 192, 144};
  const Surface ball = all_of({plane({}, {0, 0, 1}), sphere({0, 0, 0.5}, 0.5)});
  for (const Camera& projection :
       {camera_from_fov(40, window, 1), camera_from_ortho_width(4, window, 1)}) {
    const double off = shares_that_differ(ball, tilted(projection, 50), window).all;
    fmt::print("shadow of a ball, {}: {:.2f} % of pixels off\n",
               projection.orthographic ? "ortho" : "persp", 100 * off);
    EXPECT_LT(off, 0.03);
  }
}

EnvironmentFrame with_z_up() {
  EnvironmentFrame frame;
  frame.up = UpAxis::z;
  return frame;
}

TEST(BitmaskSun, ShinesThroughSlotsBetweenBoards) {
  // They are 0.18 wide, 0.02 thick and 0.07 apart; the sun is 31 degrees above the floor.
  const Window window{0, 0, 240, 180};
  std::vector<Surface> all{plane({}, {0, 0, 1})};
  for (int i = -4; i <= 4; ++i)
    all.push_back(Box{{0.25 * i - 0.09, -0.01, -0.01}, {0.25 * i + 0.09, 0.01, 0.8}}.surface());
  const Surface scene = all_of(std::move(all));
  const Environment sun = one_sun(76, 42, with_z_up());
  for (const glm::dvec3& eye : {glm::dvec3{-2, -2.6, 1.5}, glm::dvec3{1.6, -2.8, 2.2}}) {
    const Camera camera = look_at(camera_from_fov(42, window, 1), eye, {0, 0, 0.2}, {0, 0, 1});
    const Differs off = shares_that_differ(scene, camera, window, sun);
    fmt::print("boards: {:.1f} % of the lit pixels are dark, {:.1f} % of the dark ones lit\n",
               100 * off.of_lit, 100 * off.of_dark);
    EXPECT_LT(off.of_lit, 0.06);
    EXPECT_LT(off.of_dark, 0.06);
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
  const Products out = run(g, {.radius = kNoLimit,
                               .environment = one_sun(64, 21, with_z_up()),
                               .products = {.ao = true, .direct = true},
                               .slices = 2,
                               .steps = 64,
                               .solids = &solids});
  // On the floor, where the way to the sun passes the fence a little above the frame's upper
  // edge.
  float most = 0;
  for (const glm::vec3& light : out.direct.pixels) most = std::max(most, light.x);
  double pixels = 0, least = 1, mean = 0;
  for (int y = 0; y < window.height(); ++y) {
    for (int x = 40; x < 152; ++x) {
      const Point p = point_at(scene, camera, window, x, y);
      if (p.normal.z < 0.5 || p.position.y < 0.32 || p.position.y > 0.37) continue;
      const double seen = out.direct(x, y).x / most;
      pixels += 1, mean += seen, least = std::min(least, seen);
    }
  }
  fmt::print("beyond the frame: {:.2f} of a sun, at least {:.2f}\n", mean / pixels, least);
  EXPECT_GT(pixels, 200);
  EXPECT_LT(least, 0.97) << "nothing goes on";
  EXPECT_GT(least, 0.75) << "the shadow of a slat";
}

}  // namespace
}  // namespace ssdo::test::sun_test
