// SPDX-License-Identifier: Apache-2.0
//
// For what is done lane by lane; compiled once for every instruction set.
#if defined(SSDO_SIMD_BY_LANE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_SIMD_BY_LANE_INL_H_
#undef SSDO_SIMD_BY_LANE_INL_H_
#else
#define SSDO_SIMD_BY_LANE_INL_H_
#endif

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The lanes of a vector, one by one.
struct Lanes {
  alignas(64) float values[kLanes];

  HWY_INLINE explicit Lanes(V v) { store(v, values); }
  HWY_INLINE float operator[](int lane) const { return values[lane]; }
};
struct Lanes3 {
  Lanes x, y, z;

  HWY_INLINE explicit Lanes3(const V3& v) : x(v.x), y(v.y), z(v.z) {}
  HWY_INLINE glm::vec3 operator[](int lane) const { return {x[lane], y[lane], z[lane]}; }
};

/// value(lane) in each lane.
template <class Value>
HWY_INLINE V by_lane(const Value& value) {
  alignas(64) float values[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) values[lane] = value(lane);
  return load(values);
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
