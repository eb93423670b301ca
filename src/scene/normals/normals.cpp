// SPDX-License-Identifier: Apache-2.0
#include "scene/normals/normals.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace ssdo {
namespace {

/// The shorter of the two steps from a pixel to its neighbours along one axis, pointing forward.
glm::vec3 shorter_step(const Surfaces& surfels, int x, int y, int dx, int dy) {
  const glm::vec3 p(surfels(x, y).position);
  glm::vec3 best(0);
  float best_length = 0;
  for (int pixels = 1; pixels <= 2 && best_length == 0; ++pixels) {
    for (const int way : {-pixels, pixels}) {
      const auto q = surface_at(surfels, x + way * dx, y + way * dy);
      if (!q) continue;
      const glm::vec3 step = (q->position - p) / float(way);
      const float length = glm::dot(step, step);
      if (best_length == 0 || length < best_length) best = step, best_length = length;
    }
  }
  return best;
}

}  // namespace

std::optional<Surfel> surface_at(const Surfaces& surfels, int x, int y) {
  if (x < 0 || y < 0 || x >= surfels.width || y >= surfels.height) return std::nullopt;
  const std::size_t i = surfels.index(x, y);
  return surfels.is_surface(i) ? std::optional(surfels[i]) : std::nullopt;
}

glm::vec3 gradient_normal(const Surfaces& surfels, int x, int y, const glm::vec3& view) {
  const glm::vec3 right = shorter_step(surfels, x, y, 1, 0);
  const glm::vec3 down = shorter_step(surfels, x, y, 0, 1);
  const glm::vec3 n = glm::cross(down, right);
  const float length = glm::length(n);
  if (!std::isnormal(length * length)) return glm::vec3(0);
  return glm::dot(n, view) < 0 ? -n / length : n / length;
}

}  // namespace ssdo
