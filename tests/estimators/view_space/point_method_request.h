// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "estimators/registry.h"
#include "support/analytic_scene.h"
#include "support/chosen_isa.h"
#include "support/scene_of.h"

namespace ssdo::test {

/// What a test asks of a method that samples points; the rest are its defaults.
struct PointRequest {
  float radius = 1;
  std::vector<std::string> set = {};
  unsigned seed = 0;
  bool direct = false;
  Environment environment = Environment::constant(glm::vec3(1));
};

inline Products run(const Method& method, const Geometry& geometry, const PointRequest& request) {
  return method.estimate(scene_of(geometry, request.environment),
                         {.products = {.ao = true, .direct = request.direct},
                          .radius = request.radius,
                          .seed = request.seed,
                          .parameters = resolve_parameters(method, request.set)},
                         {});
}

/// A floor, a wall, and a ball in front of the wall that hides part of both.
inline Surface room_with_a_ball() {
  return all_of({plane({}, {0, 0, 1}), plane({0, 1.5, 0}, {0, -1, 0}), sphere({0.3, 0, 1.2}, 0.6)});
}

/// A disc of radius 1 at z = 0 before a plane at z = -depth.
inline Surface disc_before_a_plane(double depth) {
  return all_of({cut(plane({}, {0, 0, 1}), [](const glm::dvec3& p) { return glm::length(p) < 1; }),
                 plane({0, 0, -depth}, {0, 0, 1})});
}

/// The pixel of the frame that shows a camera-space point, and the depth in it, in double; false
/// where there is none.
inline bool depth_at(const Geometry& g, const glm::dvec3& point, double& z) {
  if (point.z >= 0) return false;
  const glm::dvec2 place = g.camera.project(point);
  const double x = std::floor(place.x) - g.window.x0, y = std::floor(place.y) - g.window.y0;
  if (!(x >= 0 && y >= 0 && x < g.surfaces.width && y < g.surfaces.height)) return false;
  const Surfel& s = g.surfaces(int(x), int(y));
  z = s.position.z;
  return s.is_surface();
}

inline double slow_smoothstep(double from, double to, double x) {
  const double t = std::min(std::max((x - from) / (to - from), 0.0), 1.0);
  return t * t * (3 - 2 * t);
}

/// Whether two ways to compute the same agree: a sample that rounding moves to the next pixel may
/// change a few pixels.
inline void expect_close(const Plane<float>& found, const std::function<double(int, int)>& expected,
                         double tolerance = 1e-4, double share_off = 0.002) {
  int off = 0, hidden = 0;
  double worst = 0;
  for (int y = 0; y < found.height; ++y) {
    for (int x = 0; x < found.width; ++x) {
      const double error = std::abs(found(x, y) - expected(x, y));
      off += !(error <= tolerance);
      worst = std::max(worst, error);
      hidden += found(x, y) < 0.95;
    }
  }
  EXPECT_LE(off, share_off * double(found.size())) << "at most off by " << worst;
  EXPECT_LT(worst, 0.15);
  // What is open everywhere tests nothing.
  EXPECT_GT(hidden, 0.05 * double(found.size()));
}

}  // namespace ssdo::test
