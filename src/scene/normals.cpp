// SPDX-License-Identifier: Apache-2.0
#include "scene/normals.h"

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <vector>

namespace ssdo {
namespace {

/// The shorter of the two steps from a pixel to its neighbours along one axis, pointing forward.
glm::vec3 shorter_step(const Plane<Surfel>& surfels, int x, int y, int dx, int dy) {
  const glm::vec4 p = surfels(x, y).position;
  glm::vec3 best(0);
  float best_length = 0;
  for (const int sign : {-1, 1}) {
    const int qx = x + sign * dx, qy = y + sign * dy;
    if (qx < 0 || qy < 0 || qx >= surfels.width || qy >= surfels.height) continue;
    const glm::vec4 q = surfels(qx, qy).position;
    if (q.w == 0) continue;
    const glm::vec3 step = float(sign) * glm::vec3(q - p);
    const float length = glm::dot(step, step);
    if (best_length == 0 || length < best_length) best = step, best_length = length;
  }
  return best;
}

bool is_usable(const glm::vec3& n) {
  const float length = glm::dot(n, n);
  return length > 1e-8f && length < 1e8f;
}

}  // namespace

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

NormalSpace find_normal_space(const Plane<glm::vec3>& stored, const Plane<Surfel>& surfels,
                              const glm::mat3& rotation, bool orthographic) {
  std::vector<NormalSpace> spaces = {{rotation, "the space of P", 0},
                                     {-rotation, "the space of P, turned round", 0},
                                     {glm::mat3(1), "camera space", 0}};
  constexpr std::array<const char*, 3> axes = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    glm::mat3 flip(1);
    flip[axis][axis] = -1;
    spaces.push_back(
        {flip, std::string("camera space, ") + axes[std::size_t(axis)] + " turned", 0});
  }
  std::vector<std::vector<float>> cosines(spaces.size());
  const std::size_t stride = (surfels.size() / 20000) | 1;
  for (std::size_t i = 0; i < surfels.size(); i += stride) {
    if (surfels[i].position.w == 0 || !is_usable(stored[i])) continue;
    const int x = int(i % std::size_t(surfels.width)), y = int(i / std::size_t(surfels.width));
    const glm::vec3 g = gradient_normal(
        surfels, x, y, direction_to_viewer(glm::vec3(surfels[i].position), orthographic));
    if (g == glm::vec3(0)) continue;
    for (std::size_t s = 0; s < spaces.size(); ++s) {
      cosines[s].push_back(glm::dot(g, glm::normalize(spaces[s].to_camera * stored[i])));
    }
  }
  for (std::size_t s = 0; s < spaces.size(); ++s) {
    auto& c = cosines[s];
    if (c.empty()) return spaces[0];
    std::nth_element(c.begin(), c.begin() + std::ptrdiff_t(c.size() / 2), c.end());
    spaces[s].agreement = c[c.size() / 2];
  }
  // The space of P is the rule; another has to be clearly better.
  std::size_t best = 0;
  for (std::size_t s = 1; s < spaces.size(); ++s) {
    if (spaces[s].agreement > spaces[best].agreement + (best == 0 ? 0.02 : 0.0)) best = s;
  }
  return spaces[best];
}

}  // namespace ssdo
