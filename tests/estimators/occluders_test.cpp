// SPDX-License-Identifier: Apache-2.0
//
// What is in the way of a ray, up to where it ends: methods that follow rays have the answer of
// rays in double, for a sun, for lamps before and behind an occluder, and for what is mirrored.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <memory>

#include "estimators/bitmask/request.h"
#include "estimators/trace.h"
#include "scene/light/painted_map.h"
#include "support/boxes.h"
#include "support/point_source.h"
#include "support/sun_of.h"

namespace ssdo::test::occluders_test {
namespace {

const Window kWindow{0, 0, 160, 120};

/// A slab above a floor, seen from aside.
Surface slab_above_floor() {
  return all_of({plane({}, {0, 0, 1}), Box{{-0.6, -0.6, 0.8}, {0.6, 0.6, 1}}.surface()});
}

Camera camera_aside() { return tilted(camera_from_fov(40, kWindow, 1), 35, 6, {0, 0, 0.4}); }

/// Black but for a point at 60 degrees.
Environment one_sun() {
  return paint(512, [](const glm::vec3& d) {
    return glm::vec3(in_disc(d, direction_of(20, 60), 0.5f) ? 3000.0f : 0.0f);
  });
}

Products estimate(const Method& method, const Scene& scene, const ProductSet& products) {
  Request request{.products = products,
                  .radius = kNoLimit,
                  .slices = 4,
                  .steps = 512,
                  .extend_offscreen = false};
  if (method.products.reflection) request.parameters["roughness"] = 0.02;
  if (method.is_reference) request.parameters["samples"] = 16;
  return method.estimate(scene, request, {});
}

/// Pixels of the floor for which an answer is more than half away from `expected(point)`, of those
/// for which that is 0 and of those for which it is 1.
struct Wrong {
  double of_hidden = 0, of_open = 0;
  bool has_hidden = false;
};
template <class Found, class Expected>
Wrong wrong(const Surface& surface, const Found& found, const Expected& expected) {
  double hidden = 0, open = 0;
  Wrong sum;
  for (int y = 2; y < kWindow.height() - 2; ++y) {
    for (int x = 2; x < kWindow.width() - 2; ++x) {
      const Point p = point_at(surface, camera_aside(), kWindow, x, y);
      if (p.position.z > 0.5) continue;
      const bool is_open = expected(p), off = (found(x, y) > 0.5f) != is_open;
      (is_open ? open : hidden) += 1;
      (is_open ? sum.of_open : sum.of_hidden) += off;
    }
  }
  EXPECT_GT(open, 100);
  sum.has_hidden = hidden > 20;
  if (hidden > 0) sum.of_hidden /= hidden;
  sum.of_open /= open;
  return sum;
}

TEST(Occluders, AreAskedUpToWhereTheRayEnds) {
  const Surface surface = slab_above_floor();
  const Camera camera = camera_aside();
  const Geometry g = geometry_of(surface, camera, kWindow);
  Scene scene = scene_of(g, one_sun());
  scene.solids = constant_thickness(g, 0.24f);
  ASSERT_EQ(scene.light.sources.size(), 1u);
  const glm::dvec3 to_sun =
      glm::transpose(camera.rotation) * glm::dvec3(sun_of(scene.light).direction);
  // Below the slab, and above it.
  const glm::dvec3 lamps[2] = {{0.1, 0.1, 0.6}, {0.1, 0.2, 3}};
  for (const glm::dvec3& lamp : lamps)
    scene.light.sources.push_back(std::make_shared<PointSource>(glm::vec3(camera.to_camera(lamp))));
  for (const Method& method : {bitmask_method(), trace_method()}) {
    const Products out = estimate(method, scene, {.ao = true, .direct = true, .reflection = true});
    ASSERT_EQ(out.visibility.sources.size(), 3u);
    const auto check = [&](const char* what, const Plane<float>& shares, const auto& expected) {
      const Wrong off = wrong(surface, shares, expected);
      fmt::print("{}, {}: {:.4f} of the hidden and {:.4f} of the open pixels are wrong\n",
                 method.name, what, off.of_hidden, off.of_open);
      EXPECT_LT(off.of_hidden, 0.06) << method.name << ": " << what;
      EXPECT_LT(off.of_open, 0.02) << method.name << ": " << what;
      return off.has_hidden;
    };
    EXPECT_TRUE(check("a sun", out.visibility.sources[0],
                      [&](const Point& p) { return is_open(surface, p, to_sun, kNoLimit); }));
    for (int k = 0; k < 2; ++k) {
      const bool has_hidden =
          check(k == 0 ? "a lamp below the slab" : "a lamp above it", out.visibility.sources[k + 1],
                [&](const Point& p) {
                  const glm::dvec3 way = lamps[k] - p.position;
                  return is_open(surface, p, glm::normalize(way), glm::length(way));
                });
      EXPECT_EQ(has_hidden, k == 1);
    }
    check("what is mirrored", out.reflection, [&](const Point& p) {
      const glm::dvec3 from_eye = glm::normalize(p.position - glm::dvec3(camera.origin));
      return is_open(surface, p, glm::reflect(from_eye, p.normal), kNoLimit);
    });
  }
}

}  // namespace
}  // namespace ssdo::test::occluders_test
