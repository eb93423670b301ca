// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/geometric.hpp>

#include "scene/surfel.h"

namespace ssdo {

/// Whether methods can work with what a pixel shows: a surface in front of the viewer, whose
/// position has a square with room for sums, with a normal of about unit length.
inline bool is_usable(const Surfel& s) {
  constexpr float kNearest = 1e-15f, kFarthest2 = 1e30f;
  const glm::vec3 p(s.position), n(s.normal);
  // Not-a-number is neither below nor above anything.
  return s.position.w != 0 && p.z < -kNearest && glm::dot(p, p) < kFarthest2 &&
         glm::dot(n, n) > 0.5f && glm::dot(n, n) < 2 && s.normal.w * s.normal.w < kFarthest2;
}

}  // namespace ssdo
