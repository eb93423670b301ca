// SPDX-License-Identifier: Apache-2.0
//
// Light on vectors of surfaces; compiled once for every instruction set.
#if defined(SSDO_SCENE_LIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_SCENE_LIGHT_INL_H_
#undef SSDO_SCENE_LIGHT_INL_H_
#else
#define SSDO_SCENE_LIGHT_INL_H_
#endif

#include <cmath>

#include "scene/light/light.h"
#include "simd/lanes-inl.h"
#include "simd/octahedral_map-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The cosine between each normal and a direction, where it is positive; else 0.
HWY_INLINE V facing(const V3& normal, const glm::vec3& to) {
  return hn::Max(dot(normal, set(to)), set(0));
}

/// Sun::cosine(): the points of a source are looked at only where it crosses the horizon of a lane.
HWY_INLINE V facing(const Sun& sun, const V3& normal) {
  const V middle = dot(normal, set(sun.direction)), edge = set(std::sin(sun.angular_radius));
  const V whole = hn::IfThenElseZero(middle >= edge, middle);
  const M part = hn::And(middle<edge, middle> hn::Neg(edge));
  if (!any(part)) return whole;
  const V radius = set(sun.point_radius), weight = set(1 / (4 * sun.point_radius));
  V sum = set(0);
  for (const glm::vec3& point : sun.points) {
    const V cosine = dot(normal, set(point));
    const V cut = hn::Max(radius - hn::Abs(cosine), set(0));
    sum = sum + hn::MulAdd(cut * cut, weight, hn::Max(cosine, set(0)));
  }
  return hn::IfThenElse(part, sum * set(1 / float(sun.points.size())), whole);
}

/// The direct light of a sun on surfaces with nothing around them.
HWY_INLINE V3 unoccluded(const Sun& sun, const V3& normal) {
  return set(sun.irradiance) * facing(sun, normal);
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
