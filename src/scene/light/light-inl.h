// SPDX-License-Identifier: Apache-2.0
//
// Light on vectors of surfaces; compiled once for every instruction set.
#if defined(SSDO_SCENE_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_SCENE_LIGHT_INL_H_
#undef SSDO_SCENE_LIGHT_INL_H_
#else
#define SSDO_SCENE_LIGHT_INL_H_
#endif

#include "scene/light/light.h"
#include "simd/lanes-inl.h"
#include "simd/octahedral_map-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The cosine between each normal and a direction, where it is positive; else 0.
HWY_INLINE V facing(const V3& normal, const glm::vec3& to) {
  return hn::Max(dot(normal, set(to)), set(0));
}

/// The direct light of a sun on surfaces with nothing around them.
HWY_INLINE V3 unoccluded(const Sun& sun, const V3& normal) {
  return set(sun.irradiance) * facing(normal, sun.direction);
}

/// Light::unoccluded()
HWY_INLINE V3 unoccluded(const Light& light, const V3& normal) {
  V3 sum = look_up(light.irradiance, normal);
  for (const Sun& sun : light.suns) sum = sum + unoccluded(sun, normal);
  return sum;
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
