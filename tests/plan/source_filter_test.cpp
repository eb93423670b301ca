// SPDX-License-Identifier: Apache-2.0
//
// --filter source: each method's filter is that of its source, where its source has it.
#include <gmock/gmock.h>

#include <cmath>

#include "estimators/slow_ssao_fade.h"
#include "plan/make_plan.h"
#include "relight/estimate.h"
#include "support/estimate_light.h"

namespace ssdo::test::source_filter_test {
namespace {

using testing::Contains;

Plan plan_of(const Scene& scene, const std::string& method,
             const std::vector<std::string>& set = {}) {
  ModelOptions model;
  model.method = method;
  if (find_method(method).supports.radius) model.radius = 0.8;
  model.set = set;
  model.filter = kPublishedFilter;
  OutputOptions output;
  output.products = {"ao"};
  return make_plan(model, output, scene, {}, "in.exr");
}

Geometry room() {
  const Window odd{0, 0, 93, 71};
  return geometry_of(room_with_a_ball(), tilted(camera_from_fov(50, odd, 1), 55), odd);
}

struct MethodAndFilter {
  std::string method, filter;
  std::vector<std::string> set = {};
  bool half = false;
};

TEST(PublishedFilter, IsThatOfTheSourceAndThePlanSaysSo) {
  const Scene scene = scene_of(room());
  const MethodAndFilter cases[] = {{"bitmask", "geometry"},
                                   {"trace", "none"},
                                   {"ssdo", "geometry"},
                                   {"ssao", "box"},
                                   {"ssao-range", "normal"},
                                   {"ssao-fade", "gaussian", {}, true},
                                   {"ssao-fade", "gaussian", {"upsampling=2"}, true},
                                   {"ssao-fade", "gaussian", {"upsampling=0"}},
                                   {"hbao", "normal"},
                                   {"gtao", "geometry"},
                                   {"sao", "depth"},
                                   {"msvo", "none"}};
  for (const MethodAndFilter& c : cases) {
    SCOPED_TRACE(c.method);
    const Plan plan = plan_of(scene, c.method, c.set);
    EXPECT_EQ(plan.filter_name(), c.filter);
    EXPECT_EQ(plan.filter->name, c.half ? "none" : c.filter);
    EXPECT_EQ(bool(plan.request.filter_half), c.half);
    EXPECT_THAT(plan.reasons, Contains("filter " + c.filter + ": that of the method's source" +
                                       (c.half ? ", on the map at half resolution" : "")));
  }
}

/// One pass of the blur of ssao-fade's source over a map, along (dx, dy).
Plane<double> slow_pass(const Plane<double>& map, const Geometry& g, int dx, int dy) {
  Plane<double> out = map;
  const auto surfel = [&](int x, int y) {
    const glm::ivec2 pixel = sampled_pixel(g, x, y);
    return g.surfaces(pixel.x, pixel.y);
  };
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      const Surfel& p = surfel(x, y);
      double sum = 0, weights = 0;
      for (int i = -5; i <= 5 && p.is_surface(); ++i) {
        const int qx = x + i * dx, qy = y + i * dy;
        if (qx < 0 || qy < 0 || qx >= map.width || qy >= map.height) continue;
        const Surfel& q = surfel(qx, qy);
        if (!q.is_surface() || glm::dot(p.normal, q.normal) < 0.8f) continue;
        if (std::abs(p.position.z - q.position.z) > 2) continue;
        const double weight = std::exp(-i * i / (2 * 2.5 * 2.5));
        sum += weight * map(qx, qy), weights += weight;
      }
      if (weights > 0) out(x, y) = sum / weights;
    }
  }
  return out;
}

TEST(PublishedFilter, OfSsaoFadeIsThreeRoundsAtHalfResolutionThatThenGoUp) {
  const Geometry g = room();
  const Scene scene = scene_of(g);
  Plane<double> half = slow_half_map(g, 0.8f);
  for (int round = 0; round < 3; ++round) half = slow_pass(slow_pass(half, g, 1, 0), g, 0, 1);
  const Estimate found = estimate_light(scene, plan_of(scene, "ssao-fade"));
  expect_close(
      found.products.ao, [&](int x, int y) { return slow_bilinear(half, x, y); }, 2e-4, 0.02);
}

}  // namespace
}  // namespace ssdo::test::source_filter_test
