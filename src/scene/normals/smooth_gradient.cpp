// SPDX-License-Identifier: Apache-2.0
#include "scene/normals/smooth_gradient.h"

#include <glm/geometric.hpp>

#include "scene/normals/normals.h"
#include "scene/straight.h"

namespace ssdo {
namespace {

/// Distance of two positions over the rounding of P from which on their direction is known to a
/// sixteenth.
constexpr float kOverRounding = 32;

/// The step across a pixel along one axis where P is smooth: to the nearest pixels on both sides
/// that are far enough apart for the precision of P, if all three are on a line.
std::optional<glm::vec3> smooth_step(const Surfaces& surfels, int x, int y, int dx, int dy) {
  const Surfel& s = surfels(x, y);
  const glm::vec3 p(s.position);
  for (const int pixels : {1, 2, 4, 8, 16}) {
    const auto a = surface_at(surfels, x - pixels * dx, y - pixels * dy);
    const auto b = surface_at(surfels, x + pixels * dx, y + pixels * dy);
    if (!a || !b) continue;
    const glm::vec3 before(a->position), after(b->position), step = after - before;
    if (!(glm::length(step) > kOverRounding * s.rounding)) continue;
    if (!is_straight(before, p, after, kStraight)) return std::nullopt;
    return step;
  }
  return std::nullopt;
}

}  // namespace

std::optional<glm::vec3> smooth_gradient(const Surfaces& surfels, int x, int y,
                                         const glm::vec3& view) {
  const auto right = smooth_step(surfels, x, y, 1, 0), down = smooth_step(surfels, x, y, 0, 1);
  if (!right || !down) return std::nullopt;
  const glm::vec3 n = glm::cross(*down, *right);
  const float length = glm::length(n);
  if (!(length > 0)) return std::nullopt;
  return glm::dot(n, view) < 0 ? -n / length : n / length;
}

}  // namespace ssdo
