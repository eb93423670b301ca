// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace ssdo {

/// Whether three positions lie on a line, the middle one halfway between the others: it is off by
/// less than `most` / 2 of their distance.
inline bool is_straight(const glm::vec3& before, const glm::vec3& middle, const glm::vec3& after,
                        float most) {
  return glm::length(after + before - 2.0f * middle) < most * glm::length(after - before);
}

}  // namespace ssdo
