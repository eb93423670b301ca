// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "scene/light/light_group.h"
#include "scene/scene.h"

namespace ssdo {

/// The radiance that surfaces of other views send, by vertex: albedo times the light that arrives.
struct OtherViewLight {
  std::vector<glm::vec3> seen;    ///< from the side that a view has seen
  std::vector<glm::vec3> unseen;  ///< from the other side
};

/// The radiance they send of one light, or of all lights as one, after 0, 1, ..., `bounces`
/// bounces, by rays among all that is known of the scene. `radius` is the farthest at which things
/// occlude.
std::vector<OtherViewLight> light_other_surfaces(const Scene& scene, const LightGroup& light,
                                                 int bounces, float radius);

}  // namespace ssdo
