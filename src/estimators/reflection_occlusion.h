// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>

#include "estimators/estimator.h"

namespace ssdo {

/// Share of a reflection that is not occluded, 0..1; see reflection_occlusion.cpp. `bent` points
/// to what is visible, its length in 0..1 says how wide that is taken to be; `reflected` is the
/// unit direction that a mirror shows; roughness and strength are in 0..1.
float reflection_occlusion(const glm::vec3& bent, const glm::vec3& reflected, float roughness,
                           float strength);

/// The same for every pixel, from bent normals in camera space that were not made unit. Roughness
/// is that of the layer, else the parameter "roughness"; the strength is the parameter
/// "reflection-strength". Background: 1.
Plane<float> reflection_occlusion(const EstimateInput& in, const Plane<glm::vec3>& bent);

}  // namespace ssdo
