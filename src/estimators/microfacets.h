// SPDX-License-Identifier: Apache-2.0
//
// Rough mirrors as facets with the distribution of Trowbridge and Reitz (GGX), in the frame of
// their surface: z is the normal. `alpha` is the square of what artists call roughness.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace ssdo {

/// The normal of a facet that a viewer in this unit direction sees, each as often as it is seen:
/// Heitz 2018, Sampling the GGX Distribution of Visible Normals. `u` in the unit square.
inline glm::vec3 visible_facet(const glm::vec3& viewer, float alpha, const glm::vec2& u) {
  // Stretched by alpha, the facets are those of a half-ball.
  const glm::vec3 v = glm::normalize(glm::vec3(alpha * viewer.x, alpha * viewer.y, viewer.z));
  const float flat = v.x * v.x + v.y * v.y;
  const glm::vec3 t = flat > 0 ? glm::vec3(-v.y, v.x, 0) / std::sqrt(flat) : glm::vec3(1, 0, 0),
                  b = glm::cross(v, t);
  // A point of the half-ball's picture: a half-disc, and another one foreshortened.
  const float r = std::sqrt(u.x), azimuth = 2 * glm::pi<float>() * u.y;
  const float x = r * std::cos(azimuth), whole = std::sqrt(std::max(0.0f, 1 - x * x)),
              share = 0.5f * (1 + v.z), y = (1 - share) * whole + share * r * std::sin(azimuth);
  const glm::vec3 n = x * t + y * b + std::sqrt(std::max(0.0f, whole * whole - y * y)) * v;
  return glm::normalize(glm::vec3(alpha * n.x, alpha * n.y, std::max(0.0f, n.z)));
}

/// The share of the facets facing a direction, with this cosine to the normal, that others do not
/// hide from it (Smith).
inline float smith_share(float cosine, float alpha) {
  const float sine2 = 1 - cosine * cosine;
  return 2 * cosine / (cosine + std::sqrt(cosine * cosine + alpha * alpha * sine2));
}

/// Where light comes from that one facet sends to the viewer.
struct FacetSample {
  glm::vec3 to{0};  ///< unit
  float share = 0;  ///< of it that other facets leave; 0: from below the surface
};

/// For one point of the unit square; all of them together are what the surface mirrors. `roughness`
/// in 0..1; a mirror is not quite one.
inline FacetSample mirror_at_facet(const glm::vec3& viewer, float roughness, const glm::vec2& u) {
  constexpr float kSharpest = 1e-3f;
  const float alpha = std::max(roughness * roughness, kSharpest);
  const glm::vec3 to = glm::reflect(-viewer, visible_facet(viewer, alpha, u));
  return {to, to.z > 0 ? smith_share(to.z, alpha) : 0};
}

}  // namespace ssdo
