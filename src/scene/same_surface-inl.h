// SPDX-License-Identifier: Apache-2.0
//
// The rule of same_surface.h for vectors; compiled once for every instruction set.
#if defined(SSDO_SCENE_SAME_SURFACE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_SCENE_SAME_SURFACE_INL_H_
#undef SSDO_SCENE_SAME_SURFACE_INL_H_
#else
#define SSDO_SCENE_SAME_SURFACE_INL_H_
#endif

#include "scene/same_surface.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// ramp(sine / kPlaneSine)
HWY_INLINE V plane_weight(V sine) {
  return saturate(hn::NegMulAdd(sine, set(2 / kPlaneSine), set(2)));
}

/// Where a height above a plane, over the distance to it, is a sine of `sine` at most: with
/// kPlaneSine / 2 where the weight is 1, with kPlaneSine where it is not 0.
HWY_INLINE M within_sine(V height, V distance2, float sine) {
  return height * height <= distance2 * set(sine * sine);
}

/// ramp((1 - cosine) / (1 - kNormalCosine)), of the cosine between two normals.
HWY_INLINE V normal_weight(V cosine) {
  constexpr float kSlope = 2 / (1 - kNormalCosine);
  return saturate(hn::MulAdd(cosine, set(kSlope), set(2 - kSlope)));
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
