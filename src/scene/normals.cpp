// SPDX-License-Identifier: Apache-2.0
#include "scene/normals.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace ssdo {
namespace {

/// The shorter of the two steps from a pixel to its neighbours along one axis, pointing forward.
glm::vec3 shorter_step(const Plane<Surfel>& surfels, int x, int y, int dx, int dy) {
  const glm::vec3 p(surfels(x, y).position);
  glm::vec3 best(0);
  float best_length = 0;
  for (int pixels = 1; pixels <= 2 && best_length == 0; ++pixels) {
    for (const int way : {-pixels, pixels}) {
      const Surfel* q = surface_at(surfels, x + way * dx, y + way * dy);
      if (!q) continue;
      const glm::vec3 step = (q->position - p) / float(way);
      const float length = glm::dot(step, step);
      if (best_length == 0 || length < best_length) best = step, best_length = length;
    }
  }
  return best;
}

/// From the pixel before along one axis to the one after, where the surface is smooth: those two
/// and the pixel lie about on a line. Zero elsewhere.
glm::vec3 smooth_step(const Plane<Surfel>& surfels, int x, int y, int dx, int dy) {
  constexpr float kMostBend = 0.05f;      // sine between the halves
  constexpr float kMostUneven = 1.3f;     // longer to shorter half
  constexpr float kMostRounding = 0.03f;  // of the step
  // At the border and beside background, from the two on the other side.
  const Surfel& here = surfels(x, y);
  const Surfel *before = surface_at(surfels, x - dx, y - dy), *middle = &here,
               *after = surface_at(surfels, x + dx, y + dy);
  if (!before) before = middle, middle = after, after = surface_at(surfels, x + 2 * dx, y + 2 * dy);
  if (!after) after = middle, middle = before, before = surface_at(surfels, x - 2 * dx, y - 2 * dy);
  if (!before || !middle || !after) return glm::vec3(0);
  const glm::vec3 first = middle->position - before->position,
                  second = after->position - middle->position, step = first + second,
                  bend = glm::cross(first, second);
  const float first2 = glm::dot(first, first), second2 = glm::dot(second, second);
  const bool even =
      std::max(first2, second2) <= kMostUneven * kMostUneven * std::min(first2, second2);
  const bool straight = glm::dot(first, second) > 0 &&
                        glm::dot(bend, bend) <= kMostBend * kMostBend * first2 * second2;
  const bool known =
      here.rounding * here.rounding <= kMostRounding * kMostRounding * glm::dot(step, step);
  return even && straight && known ? step : glm::vec3(0);
}

}  // namespace

const Surfel* surface_at(const Plane<Surfel>& surfels, int x, int y) {
  if (x < 0 || y < 0 || x >= surfels.width || y >= surfels.height) return nullptr;
  const Surfel& s = surfels(x, y);
  return s.is_surface() ? &s : nullptr;
}

glm::vec3 direction_to_viewer(const glm::vec3& p, bool orthographic) {
  return orthographic ? glm::vec3(0, 0, 1) : -glm::normalize(p);
}

glm::vec3 gradient_normal(const Plane<Surfel>& surfels, int x, int y, const glm::vec3& view) {
  const glm::vec3 right = shorter_step(surfels, x, y, 1, 0);
  const glm::vec3 down = shorter_step(surfels, x, y, 0, 1);
  const glm::vec3 n = glm::cross(down, right);
  const float length = glm::length(n);
  if (!(length > 0)) return glm::vec3(0);
  return glm::dot(n, view) < 0 ? -n / length : n / length;
}

glm::vec3 geometric_normal(const Plane<Surfel>& surfels, int x, int y, const glm::vec3& view) {
  constexpr float kSameCosine = 0.9994f, kSteep = 0.05f;
  const glm::vec3 shading = surfels(x, y).normal;
  const glm::vec3 n =
      glm::cross(smooth_step(surfels, x, y, 0, 1), smooth_step(surfels, x, y, 1, 0));
  const float length = glm::length(n);
  if (!(length > 0)) return shading;
  const glm::vec3 normal = n / (glm::dot(n, view) < 0 ? -length : length);
  // A surface so steep may be the average of what is before an edge and what is behind it.
  const bool steep = glm::dot(normal, view) < kSteep;
  return steep || glm::dot(normal, shading) > kSameCosine ? shading : normal;
}

}  // namespace ssdo
