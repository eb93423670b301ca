// SPDX-License-Identifier: Apache-2.0
//
// Light between surfaces as a function of visibility and albedo: Jimenez, Wu, Pesce, Jarabo,
// "Practical Realtime Strategies for Accurate Indirect Occlusion", 2016. A cubic that the authors
// fitted to path-traced interreflection, where all surfaces around have the receiver's albedo:
//
//   max(x, ((x a + b) x + c) x)   a = 2.0404 rho - 0.3324   b = -4.7951 rho + 0.6417
//                                 c = 2.7552 rho + 0.6903
//
// Engines print the numbers with two digits; these are the authors'.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>

namespace ssdo {

/// What stands for the visibility `ao` when bounces among surfaces of this albedo are counted in,
/// by channel: from ao to 1.0001. An albedo outside [0, 1], where the fit ends, counts as the
/// nearest in it; not-a-number as 0.
inline glm::vec3 multi_bounce(float ao, const glm::vec3& albedo) {
  glm::vec3 sum;
  for (int c = 0; c < 3; ++c) {
    const float rho = std::isnan(albedo[c]) ? 0.0f : std::clamp(albedo[c], 0.0f, 1.0f);
    const float cubic = 2.0404f * rho - 0.3324f, square = -4.7951f * rho + 0.6417f,
                linear = 2.7552f * rho + 0.6903f;
    sum[c] = std::max(ao, ((ao * cubic + square) * ao + linear) * ao);
  }
  return sum;
}

}  // namespace ssdo
