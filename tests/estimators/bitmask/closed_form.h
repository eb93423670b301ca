// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "estimators/bitmask/request.h"

namespace ssdo::test {

/// The frame of closed forms; its views are 2.4 units wide, so that a unit is 200 pixels.
const Window kFineWindow{0, 0, 480, 400};

/// ao of a point of a scene.
using Formula = std::function<double(const glm::dvec3& position_world)>;

/// What a scene hides of itself, where that is not everything.
using Backs = std::function<Solids(const Geometry&, const Camera&)>;

/// The same view in a frame of half as many pixels each way.
inline Window halved(const Window& w) { return {w.x0 / 2, w.y0 / 2, w.x1 / 2, w.y1 / 2}; }
inline Camera halved(Camera camera) {
  camera.fx /= 2, camera.fy /= 2, camera.cx /= 2, camera.cy /= 2;
  return camera;
}

/// How far ao is off in the middle of a frame, on average over a square of 1/30 of its width.
inline double error_of_ao(const Surface& scene, const Camera& camera, const Window& window,
                          BitmaskRequest request, const Formula& formula, const Backs& backs) {
  const Geometry g = geometry_of(scene, camera, window);
  std::optional<Solids> solids;
  if (backs) request.solids = &solids.emplace(backs(g, camera));
  const int half = window.width() / 60;
  request.receivers = middle_square(window, half);
  const Products out = run(g, request);
  return middle(
      window,
      [&](int x, int y) {
        return at_pixel(out.ao, request.receivers, x, y) -
               formula(point_at(scene, camera, window, x, y).position);
      },
      half);
}

/// Holds method bitmask to a formula, and the formula to rays. Occluders must be solid, with their
/// fronts and all of their outlines that matter in view. A pixel knows an edge to half its width,
/// an error in proportion to that width: the limit of small pixels is found from two frames.
inline void expect_closed_form(const std::string& name, const Surface& scene, const Camera& camera,
                               const BitmaskRequest& request, const Formula& formula,
                               const Backs& backs = {}) {
  const Window window = kFineWindow, half = halved(window);
  const double fine = error_of_ao(scene, camera, window, request, formula, backs),
               coarse = error_of_ao(scene, halved(camera), half, request, formula, backs),
               limit = 2 * fine - coarse;
  const auto point = [&](int x, int y) { return point_at(scene, camera, window, x, y); };
  const double expected =
      middle(window, [&](int x, int y) { return formula(point(x, y).position); });
  const double by_rays =
      middle(window, [&](int x, int y) { return ao_by_rays(scene, point(x, y), request.radius); });
  fmt::print("{:<46} expected {:.4f}  by rays {:.4f}  off by {:+.4f}, {:+.4f}; limit {:+.4f}\n",
             name, expected, by_rays, coarse, fine, limit);
  EXPECT_NEAR(by_rays, expected, 5e-4) << name;
  EXPECT_NEAR(fine, 0, 4e-3) << name;
  EXPECT_NEAR(limit, 0, 3e-3) << name;
}

}  // namespace ssdo::test
