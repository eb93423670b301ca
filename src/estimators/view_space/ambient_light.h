// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/estimator.h"

namespace ssdo {

/// Direct light of methods that know how much of the sky is open but not which part of it: ao
/// times the irradiance, over pi, that would arrive without occluders. Wrong where the light is
/// not even and the occluders are not: what is open counts as lit like the whole.
///
/// The irradiance is that of a surface with the normal `facing` (camera space, unit), the bent
/// normal of methods that have one; null, or 0 at a pixel: the pixel's own. Background: 0.
Plane<glm::vec3> ambient_light(const Scene& scene, const Plane<float>& ao,
                               const Plane<glm::vec3>* facing = nullptr);

}  // namespace ssdo
