// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace ssdo {

/// A direction in the hemisphere about the third axis of `frame`, with the density of the cosine:
/// the disc, lifted. `u` in the unit square.
inline glm::vec3 cosine_direction(const glm::mat3& frame, const glm::vec2& u) {
  const float r = std::sqrt(u.x), azimuth = 2 * glm::pi<float>() * u.y;
  return frame * glm::vec3(r * std::cos(azimuth), r * std::sin(azimuth), std::sqrt(1 - u.x));
}

}  // namespace ssdo
