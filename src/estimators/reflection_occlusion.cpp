// SPDX-License-Identifier: Apache-2.0
//
// Reflection occlusion by cones: Jimenez et al., "Practical Realtime Strategies for Accurate
// Indirect Occlusion", 2016, section 6, in the form that engines run.
//
// What a rough surface mirrors lies in a cone about the reflected direction r, what is visible in
// one about the bent normal b. Their angles are s = max(roughness, 0.1) pi and u = |b| pi strength;
// with w the angle between r and b, D = |s - u| and S = s + u,
//
//   occlusion = smoothstep(1 - saturate((w - D) / (S - D))) saturate((u - 0.1) / 0.2)
//
// is 1 where one cone lies within the other and 0 where they do not touch, or where the visible
// cone is all but closed. b must not be made unit before.
//
// Known faults, kept: of gtao, the length of b says how well its slices agree on a direction, not
// how narrow each is, so that what is hidden evenly from all sides counts as open; so does a
// narrow visible cone within a wide specular one; s reaches pi, beyond the surface, for a
// roughness of 1.
#include "estimators/reflection_occlusion.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "estimators/view_planes.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

constexpr float kSharpest = 0.1f;                 ///< roughness of the narrowest specular cone
constexpr float kClosed = 0.1f, kOpening = 0.2f;  ///< radians of the visible cone

/// The direction in which a mirror there shows the viewer.
glm::vec3 mirrored(const Surfel& surfel, bool orthographic) {
  const glm::vec3 n(surfel.normal),
      to_viewer = orthographic ? glm::vec3(0, 0, 1) : -glm::normalize(glm::vec3(surfel.position));
  return 2 * glm::dot(n, to_viewer) * n - to_viewer;
}

}  // namespace

float reflection_occlusion(const glm::vec3& bent, const glm::vec3& reflected, float roughness,
                           float strength) {
  const float length = glm::length(bent), pi = glm::pi<float>();
  const float specular = std::max(roughness, kSharpest) * pi, visible = length * pi * strength;
  if (!(visible > kClosed)) return 0;
  const float between = std::acos(std::clamp(glm::dot(bent, reflected) / length, -1.0f, 1.0f));
  // S - D is twice the smaller angle.
  const float apart = (between - std::abs(specular - visible)) / (2 * std::min(specular, visible)),
              overlap = 1 - std::clamp(apart, 0.0f, 1.0f);
  return overlap * overlap * (3 - 2 * overlap) * std::min((visible - kClosed) / kOpening, 1.0f);
}

Plane<float> reflection_occlusion(const EstimateInput& in, const Plane<glm::vec3>& bent) {
  Plane<float> out(bent.width, bent.height, 1.0f);
  const bool layer = in.roughness && !in.roughness->empty();
  const auto roughness = float(in.parameters.at("roughness")),
             strength = float(in.parameters.at("reflection-strength"));
  for_each_row(bent.height, [&](int y) {
    for (int x = 0; x < bent.width; ++x) {
      const std::size_t i = bent.index(x, y);
      const Surfel& s = in.geometry.surfel[i];
      if (!is_usable(s)) continue;
      out[i] = reflection_occlusion(bent[i], mirrored(s, in.geometry.camera.orthographic),
                                    layer ? (*in.roughness)[i] : roughness, strength);
    }
  });
  return out;
}

}  // namespace ssdo
