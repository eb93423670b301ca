// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "math/plane.h"

namespace ssdo {

/// Unit vector to the octahedral square 0..1 (Cigolle et al. 2014, A Survey of Efficient
/// Representations for Independent Unit Vectors): no trigonometry, no pole.
inline glm::vec2 octahedral_encode(const glm::vec3& d) {
  const float scale = 1 / (std::abs(d.x) + std::abs(d.y) + std::abs(d.z));
  glm::vec2 p(d.x * scale, d.y * scale);
  if (d.z < 0) {
    p = {std::copysign(1 - std::abs(p.y), p.x), std::copysign(1 - std::abs(p.x), p.y)};
  }
  return 0.5f * p + 0.5f;
}

inline glm::vec3 octahedral_decode(const glm::vec2& uv) {
  const glm::vec2 p = 2.0f * uv - 1.0f;
  glm::vec3 d(p.x, p.y, 1 - std::abs(p.x) - std::abs(p.y));
  if (d.z < 0) {
    d.x = std::copysign(1 - std::abs(p.y), p.x);
    d.y = std::copysign(1 - std::abs(p.x), p.y);
  }
  return glm::normalize(d);
}

/// Colours over the sphere, looked up by direction. Nodes lie on the edges of the square too, so
/// that the two sides of a fold share their values and bilinear interpolation has no seam.
class OctahedralMap {
 public:
  explicit OctahedralMap(int size) : nodes_(size, size) {}

  int size() const { return nodes_.width; }
  glm::vec3 direction_of(int x, int y) const {
    return octahedral_decode(glm::vec2(x, y) / float(size() - 1));
  }
  glm::vec3& operator()(int x, int y) { return nodes_(x, y); }
  const float* data() const { return &nodes_[0].x; }  ///< by row, node and channel

  glm::vec3 operator()(const glm::vec3& direction) const {
    const glm::vec2 at = octahedral_encode(direction) * float(size() - 1);
    const int x = std::clamp(int(at.x), 0, size() - 2), y = std::clamp(int(at.y), 0, size() - 2);
    const glm::vec2 f = at - glm::vec2(x, y);
    const glm::vec3* row = &nodes_(x, y);
    const glm::vec3* next = row + size();
    return glm::mix(glm::mix(row[0], row[1], f.x), glm::mix(next[0], next[1], f.x), f.y);
  }

 private:
  Plane<glm::vec3> nodes_;
};

}  // namespace ssdo
