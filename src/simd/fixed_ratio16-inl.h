// SPDX-License-Identifier: Apache-2.0
//
// Vectors of FixedRatio16; compiled once for every instruction set.
#if defined(SSDO_SIMD_FIXED_RATIO16_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_SIMD_FIXED_RATIO16_INL_H_
#undef SSDO_SIMD_FIXED_RATIO16_INL_H_
#else
#define SSDO_SIMD_FIXED_RATIO16_INL_H_
#endif

#include "math/fixed_ratio16.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

using DI16 = hn::Rebind<std::int16_t, D>;
static_assert(sizeof(FixedRatio16) == sizeof(std::int16_t));

HWY_INLINE V load(const FixedRatio16* from) {
  const auto steps = hn::LoadU(DI16(), reinterpret_cast<const std::int16_t*>(from));
  return hn::ConvertTo(D(), hn::PromoteTo(DI(), steps)) * set(1 / FixedRatio16::kSteps);
}

/// Not-a-number becomes any share.
HWY_INLINE void store(V shares, FixedRatio16* to) {
  const V most = set(FixedRatio16::kMost), clamped = hn::Min(hn::Max(shares, hn::Neg(most)), most);
  const auto steps = hn::DemoteTo(DI16(), hn::NearestInt(clamped * set(FixedRatio16::kSteps)));
  hn::StoreU(steps, DI16(), reinterpret_cast<std::int16_t*>(to));
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
