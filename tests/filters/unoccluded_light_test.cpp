// SPDX-License-Identifier: Apache-2.0
//
// What reaches a surface that has nothing around it: the same for every method, with and without
// the filter, as Light says, of the sky, a sun and a source that is not endlessly far.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "estimators/bitmask/request.h"
#include "estimators/registry.h"
#include "filters/light_visibility.h"
#include "filters/registry.h"
#include "scene/light/painted_map.h"
#include "support/fixed_frame.h"
#include "support/point_source.h"

namespace ssdo::test::unoccluded_light_test {
namespace {

const Window kWindow{0, 0, 48, 36};

/// A floor under a sky with one sun and a lamp above it.
Scene open_floor() {
  const Camera camera = tilted(camera_from_fov(30, kWindow, 1), 40);
  const Environment map = paint(256, [](const glm::vec3& d) {
    if (in_disc(d, direction_of(40, 50), 3)) return glm::vec3(100, 90, 80);
    return glm::vec3(1 + 0.3f * d.z, 1, 1 - 0.3f * d.x);
  });
  Scene scene = scene_of(geometry_of(plane({}, {0, 0, 1}), camera, kWindow), map, 0.5f);
  EXPECT_EQ(scene.light.sources.size(), 1u);
  const glm::vec3 lamp(camera.to_camera({0.3, 0.2, 1.1}));
  scene.light.sources.push_back(std::make_shared<PointSource>(lamp, glm::vec3(2, 3, 4)));
  return scene;
}

/// Largest difference from what Light says times ao, relative to it.
double largest_difference(const Scene& scene, const Products& products, bool by_ao) {
  double worst = 0;
  for (std::size_t i = 0; i < products.direct.size(); ++i) {
    const Surfel& s = scene.geometry.surfaces[i];
    if (!s.is_surface()) continue;
    const float part = by_ao ? products.ao[i] : 1;
    const glm::vec3 expected = part * scene.light.unoccluded(s.position, s.normal);
    for (int c = 0; c < 3; ++c)
      worst = std::max(worst, std::abs(double(products.direct[i][c] / expected[c]) - 1));
  }
  return worst;
}

TEST(UnoccludedLight, IsTheSameForAllThatUseIt) {
  const Scene scene = open_floor();
  int methods_with_light = 0;
  for (const Method& method : methods()) {
    if (!method.products.direct) continue;
    ++methods_with_light;
    const Products out = method.estimate(scene, fixed_request(method, 1), {});
    // What methods take for occluded on an open floor is theirs.
    const bool by_ao = out.visibility.sky.empty() && method.name != "ssdo";
    EXPECT_LT(largest_difference(scene, out, by_ao), 1e-4) << method.name;
    const Products filtered =
        filter_visibility(find_filter("geometry"), out, scene, method.pattern_size);
    EXPECT_LT(largest_difference(scene, filtered, by_ao), 1e-3) << method.name;
  }
  EXPECT_GE(methods_with_light, 5);
}

}  // namespace
}  // namespace ssdo::test::unoccluded_light_test
