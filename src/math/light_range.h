// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <glm/vec3.hpp>

namespace ssdo {

/// No light or albedo is above this, so that sums, squares and products of two stay finite.
constexpr float kBrightest = 1e15f;

/// Clamps light to +-kBrightest; NaN becomes 0. Without this, light that bounces many times between
/// surfaces with an albedo above 1 would overflow.
inline glm::vec3 within_range(const glm::vec3& light) {
  glm::vec3 clamped;
  for (int c = 0; c < 3; ++c)
    clamped[c] = light[c] == light[c] ? std::clamp(light[c], -kBrightest, kBrightest) : 0.0f;
  return clamped;
}

}  // namespace ssdo
