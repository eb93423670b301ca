// SPDX-License-Identifier: Apache-2.0
//
// Products that are composed of light:
//
//   unshadowed = F[a rho E] / F[a rho]     E: what a surface receives if nothing is in front of it
//   shadow     = direct / unshadowed       by channel; 1 where there is no light
//
// with coverage a, albedo rho and the mean F as in downsample.cpp. unshadowed times shadow is
// direct in every channel, by one multiplication in a compositor. For this, shadow is not clamped:
// methods that look light up in another direction than the normal may find more than E. Where E is
// 0, the product is 0.
#pragma once

#include <glm/vec3.hpp>

#include "color/results.h"
#include "estimators/products.h"
#include "math/plane.h"

namespace ssdo {

/// A light, or all of them as one, and its direct light.
struct LitBy {
  const Light& light;
  const Plane<glm::vec3>& direct;  ///< over the scene's window; empty where it was not made
};

/// E at every pixel of the scene; 0 where there is no surface.
Plane<glm::vec3> unoccluded_light(const Scene& scene, const Light& light);

/// `shadow_of`, over the window of the outputs.
Plane<glm::vec3> shadow_of_objects(const Product& product, const Results& results);

/// `unshadowed` or `shadow` of a light, over the window of the outputs.
Plane<glm::vec3> composed_of_light(const Product& product, const LitBy& by, const Results& results);

}  // namespace ssdo
