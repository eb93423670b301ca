// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "error.h"
#include "estimators/view_space/point_method_request.h"
#include "parallel/tiles.h"
#include "support/crop.h"

namespace ssdo::test {

inline Products obscure(const Method& method, const Geometry& g, float radius,
                        const std::vector<std::string>& set = {},
                        const Environment& sky = Environment::constant(glm::vec3(1))) {
  return run(method, g, {.radius = radius, .set = set, .direct = true, .environment = sky});
}

/// A floor before a wall, and a sphere.
inline Surface still_life() {
  return all_of({cut(plane({}, {0, 0, 1}), [](const glm::dvec3& p) { return p.y < 1; }),
                 cut(plane({0, 1, 0}, {0, -1, 0}), [](const glm::dvec3& p) { return p.z > 0; }),
                 sphere({0.4, 0.2, 0.5}, 0.5)});
}

/// A sphere with holes, spikes and a few positions that no scene has.
inline Geometry broken_geometry() {
  const Window window{0, 0, 96, 72};
  std::mt19937 random(3);
  Geometry g =
      geometry_of(sphere({0, 0, 0}, 2), tilted(camera_from_fov(40, window, 1), 30), window);
  for (std::size_t i = 0; i < g.surfaces.size(); ++i) {
    Surfel s = g.surfaces[i];
    glm::vec3& p = s.position;
    if (random() % 10 == 0) s = {};
    if (s.is_surface() && random() % 10 == 0) p *= 1e6f;
    if (s.is_surface() && random() % 10 == 0) p = glm::vec3(0, 0, -1e-30f);
    if (s.is_surface() && random() % 20 == 0) p.z = NAN;
    if (s.is_surface() && random() % 20 == 0) p.x = INFINITY;
    if (random() % 20 == 0) s.normal.y = NAN;
    if (s.is_surface() && random() % 20 == 0) s.normal = glm::vec3(0), s.rounding = 0;
    g.surfaces.set(i, s);
  }
  return g;
}

inline void expect_usable(const Products& out) {
  for (std::size_t i = 0; i < out.ao.size(); ++i) {
    ASSERT_TRUE(out.ao[i] >= 0 && out.ao[i] <= 1) << i << ": " << out.ao[i];
    for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(out.direct[i][c])) << i;
  }
}

/// ao on each instruction set that this machine has, against the scalar build: 1 pixel of 500 may
/// differ, by a sample that rounding moves.
inline void expect_the_same_from_every_isa(const std::function<Plane<float>()>& ao) {
  Plane<float> scalar;
  for (const char* name : kIsas) {
    if (!has_isa(name)) continue;
    const ChosenIsa isa(name);
    const Plane<float> found = ao();
    if (scalar.empty()) scalar = found;
    int off = 0;
    for (std::size_t i = 0; i < found.size(); ++i) off += std::abs(found[i] - scalar[i]) > 1e-5f;
    EXPECT_LE(off, int(found.size()) / 500) << name;
  }
  EXPECT_LT(*std::min_element(scalar.pixels.begin(), scalar.pixels.end()), 0.8f);
}

inline void expect_the_same_from_any_threads(const std::function<Plane<float>()>& ao) {
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    return ao();
  };
  EXPECT_EQ(with(1).pixels, with(3).pixels);
}

}  // namespace ssdo::test
