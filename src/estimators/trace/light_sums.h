// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/vec3.hpp>

namespace ssdo {

/// The spread of the means of so many parts of the samples gives the standard error.
inline constexpr int kGroups = 4;

using Groups = std::array<float, kGroups>;

/// Standard error of the mean of all groups, if the groups are independent. Groups of one sequence
/// are more even than that, so the true error is smaller. The value has the sign of the difference
/// of two halves, so that a filter averages it as it averages noise.
inline float standard_error(const Groups& groups) {
  float mean = 0, squares = 0;
  for (const float g : groups) mean += g / kGroups;
  for (const float g : groups) squares += (g - mean) * (g - mean);
  const float difference = groups[0] + groups[1] - groups[2] - groups[3];
  return std::copysign(std::sqrt(squares / (kGroups * (kGroups - 1))), difference);
}

/// The light from a hemisphere, part by part of the samples.
struct LightSums {
  std::array<glm::vec3, kGroups> open{}, all{};
  std::array<int, kGroups> seen{}, number{};

  glm::vec3 share(const glm::vec3& part, const glm::vec3& whole, float ao) const {
    glm::vec3 out;
    for (int c = 0; c < 3; ++c)
      out[c] = whole[c] > 0 ? std::clamp(part[c] / whole[c], 0.0f, 1.0f) : ao;
    return out;
  }
  glm::vec3 share_of_group(int g) const {
    return share(open[g], all[g], float(seen[g]) / float(number[g]));
  }
  glm::vec3 share_of_all(float ao) const {
    glm::vec3 part(0), whole(0);
    for (int g = 0; g < kGroups; ++g) part += open[g], whole += all[g];
    return share(part, whole, ao);
  }
};

}  // namespace ssdo
