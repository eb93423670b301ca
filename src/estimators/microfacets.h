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

/// The normal of a facet that a viewer in this unit direction sees, with the density of visible
/// normals: Heitz 2018, Sampling the GGX Distribution of Visible Normals. `u` in the unit square.
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

/// Facets by their distribution (GGX): the density of normals over the solid angle, times the
/// cosine to that of the surface. `across2` is the squared sine to the latter.
inline float facet_density(float cosine, float across2, float alpha) {
  const float q = across2 + alpha * alpha * cosine * cosine;
  return alpha * alpha / (glm::pi<float>() * q * q);
}

/// A mirror is not quite one.
inline float alpha_of(float roughness) {
  constexpr float kSharpest = 1e-3f;
  return std::max(roughness * roughness, kSharpest);
}

/// The light that one facet mirrors to the viewer: its direction, and the part that is not hidden.
struct FacetSample {
  glm::vec3 to{0};     ///< unit
  float share = 0;     ///< of that light that other facets do not hide; 0: from below the surface
  glm::vec3 facet{0};  ///< the normal of the facet
};

/// For one point of the unit square; all of them together are what the surface mirrors. `roughness`
/// in 0..1.
inline FacetSample mirror_at_facet(const glm::vec3& viewer, float roughness, const glm::vec2& u) {
  const float alpha = alpha_of(roughness);
  const glm::vec3 facet = visible_facet(viewer, alpha, u), to = glm::reflect(-viewer, facet);
  return {to, to.z > 0 ? smith_share(to.z, alpha) : 0, facet};
}

/// The density of the directions of mirror_at_facet() over the solid angle, for a viewer above the
/// surface.
inline float density_of(const FacetSample& sample, const glm::vec3& viewer, float roughness) {
  const float alpha = alpha_of(roughness), cosine = std::max(viewer.z, 1e-4f);
  const glm::vec3& h = sample.facet;
  return smith_share(cosine, alpha) * facet_density(h.z, h.x * h.x + h.y * h.y, alpha) /
         (4 * cosine);
}

/// What a facet mirrors of light that meets it at this cosine beyond what it mirrors along its
/// normal, as a part of the rest: Schlick 1994, An Inexpensive BRDF Model for Physically-based
/// Rendering. F = F0 + (1 - F0) rise.
inline float fresnel_rise(float cosine) {
  const float c = std::clamp(1 - cosine, 0.0f, 1.0f), c2 = c * c;
  return c2 * c2 * c;
}

}  // namespace ssdo
