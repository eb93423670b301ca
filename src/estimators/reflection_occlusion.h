// SPDX-License-Identifier: Apache-2.0
//
// How much of what a rough surface mirrors is open: the overlap of two cones, after Jimenez, Wu,
// Pesce, Jarabo, "Practical Realtime Strategies for Accurate Indirect Occlusion", 2016, in the form
// that game engines run. With the bent normal b, not normalised, and the mirrored view direction r:
//
//   s = pi max(roughness, 0.1)       the angle of the cone that is mirrored, about r
//   u = pi |b| / 2                   that of the cone that is open, about b: a half-ball where the
//                                    slices agree
//   beta = acos(b.r / |b|)           between the cones
//   overlap = smoothstep(0, 1, 1 - clamp((beta - |s - u|) / (s + u - |s - u|)))
//   occlusion = overlap clamp((u - 0.1) / 0.2)
//
// Known faults, kept: |b| says how well the slices agree on a direction, not how narrow each of
// them is. What is hidden evenly from all sides counts as open, and an open plane that is seen at
// a grazing angle, whose slices lean apart, as hidden in part.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "estimators/estimator.h"

namespace ssdo {

/// From 0, hidden, to 1. `bent` is the mean of unit directions, `mirrored` a unit vector in the
/// same space, roughness from 0 to 1.
inline float reflection_occlusion(const glm::vec3& bent, const glm::vec3& mirrored,
                                  float roughness) {
  constexpr float kPi = std::numbers::pi_v<float>;
  const float length = glm::length(bent);
  const float open = kPi / 2 * length, gloss = kPi * std::max(roughness, 0.1f);
  const float certain = std::clamp((open - 0.1f) / 0.2f, 0.0f, 1.0f);
  if (!(certain > 0)) return 0;
  const float between = std::acos(std::clamp(glm::dot(bent, mirrored) / length, -1.0f, 1.0f));
  const float inside = std::abs(gloss - open);
  const float t = 1 - std::clamp((between - inside) / (gloss + open - inside), 0.0f, 1.0f);
  return t * t * (3 - 2 * t) * certain;
}

/// Of every pixel, from its bent normal (camera space, a mean of unit directions); background: 1.
Plane<float> reflection_occlusion(const EstimateInput& in, const Plane<glm::vec3>& bent,
                                  float roughness);

}  // namespace ssdo
