// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <glm/trigonometric.hpp>
#include <random>
#include <string>
#include <vector>

#include "error.h"
#include "estimators/registry.h"
#include "parallel/isa.h"
#include "support/analytic_scene.h"

namespace ssdo::test {

/// What a test asks of a method; the rest are its defaults.
inline Products obscure(const Method& method, const Geometry& g, float radius,
                        const std::vector<std::string>& set = {},
                        const Environment& sky = Environment::constant(glm::vec3(1))) {
  const ParameterValues parameters = resolve_parameters(method, set);
  const Plane<glm::vec3> none;
  return method.estimate(
      {g, none, none, sky, {.ao = true, .direct = true}, radius, 0, 0, parameters, {}});
}

/// A camera `distance` away from the origin, the plane z = 0 tilted to it.
inline Camera tilted(const Camera& projection, double tilt_degrees, double distance = 6) {
  const double t = glm::radians(tilt_degrees);
  return look_at(projection, distance * glm::dvec3(0, -std::sin(t), std::cos(t)), {0, 0, 0},
                 {0, std::cos(t), std::sin(t)});
}

/// A floor before a wall, and a sphere.
inline Surface still_life() {
  return all_of({cut(plane({}, {0, 0, 1}), [](const glm::dvec3& p) { return p.y < 1; }),
                 cut(plane({0, 1, 0}, {0, -1, 0}), [](const glm::dvec3& p) { return p.z > 0; }),
                 sphere({0.4, 0.2, 0.5}, 0.5)});
}

/// What `window`, a part of a geometry's window, shows of it.
inline Geometry crop(const Geometry& g, const Window& window) {
  Geometry part = g;
  part.window = window;
  part.surfel = Plane<Surfel>(window.width(), window.height());
  for (int y = 0; y < window.height(); ++y) {
    for (int x = 0; x < window.width(); ++x)
      part.surfel(x, y) = g.surfel(x + window.x0 - g.window.x0, y + window.y0 - g.window.y0);
  }
  return part;
}

/// A sphere with holes, spikes and a few positions that no scene has.
inline Geometry broken_geometry() {
  const Window window{0, 0, 96, 72};
  std::mt19937 random(3);
  Geometry g =
      geometry_of(sphere({0, 0, 0}, 2), tilted(camera_from_fov(40, window, 1), 30), window);
  for (std::size_t i = 0; i < g.surfel.size(); ++i) {
    glm::vec4& p = g.surfel[i].position;
    if (random() % 10 == 0) p = glm::vec4(0);
    if (g.is_surface(i) && random() % 10 == 0) p *= glm::vec4(1e6f, 1e6f, 1e6f, 1);
    if (g.is_surface(i) && random() % 10 == 0) p = glm::vec4(0, 0, -1e-30f, 1);
    if (g.is_surface(i) && random() % 20 == 0) p.z = NAN;
    if (g.is_surface(i) && random() % 20 == 0) p.x = INFINITY;
    if (random() % 20 == 0) g.surfel[i].normal.y = NAN;
    if (random() % 20 == 0) g.surfel[i].normal = glm::vec4(0);
  }
  return g;
}

inline void expect_usable(const Products& out) {
  for (std::size_t i = 0; i < out.ao.size(); ++i) {
    ASSERT_TRUE(out.ao[i] >= 0 && out.ao[i] <= 1) << i << ": " << out.ao[i];
    for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(out.direct[i][c])) << i;
  }
}

/// Runs vector loops on an instruction set while it lives.
class ForcedIsa {
 public:
  explicit ForcedIsa(const std::string& isa) { setenv("SSDO_ISA", isa.c_str(), 1); }
  ~ForcedIsa() {
    unsetenv("SSDO_ISA");
    choose_isa();
  }
  /// Whether this machine has it.
  bool exists() const {
    try {
      choose_isa();
      return true;
    } catch (const Error&) {
      return false;
    }
  }
};

}  // namespace ssdo::test
