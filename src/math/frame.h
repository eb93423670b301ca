// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

namespace ssdo {

/// A right-handed orthonormal frame whose third column is the unit vector `n` (Duff et al. 2017,
/// Building an Orthonormal Basis, Revisited).
inline glm::mat3 frame_about(const glm::vec3& n) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  const float b = n.x * n.y * a;
  return {glm::vec3(1 + sign * n.x * n.x * a, sign * b, -sign * n.x),
          glm::vec3(b, sign + n.y * n.y * a, -n.y), n};
}

}  // namespace ssdo
