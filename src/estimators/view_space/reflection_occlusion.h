// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>

#include "estimators/estimator.h"
#include "estimators/view_space/view_planes.h"

namespace ssdo {

/// Share of the reflection of every pixel that is not occluded, 0..1; see reflection_occlusion.cpp.
/// `bent` points to what is visible, in camera space, and its length in 0..1 says how wide that is
/// taken to be: it was not made unit. `planes` are those of the frame. Roughness is that of the
/// layer, else the parameter of that name. A length of 1 means a cone of `strength` pi.
/// Background: 1.
Plane<float> reflection_occlusion(const Scene& scene, const Request& request,
                                  const ViewPlanes& planes, const Plane<glm::vec3>& bent,
                                  float strength);

}  // namespace ssdo
