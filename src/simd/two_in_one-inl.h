// SPDX-License-Identifier: Apache-2.0
//
// math/two_in_one.h for vectors; compiled once for every instruction set.
#if defined(SSDO_SIMD_TWO_IN_ONE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_SIMD_TWO_IN_ONE_INL_H_
#undef SSDO_SIMD_TWO_IN_ONE_INL_H_
#else
#define SSDO_SIMD_TWO_IN_ONE_INL_H_
#endif

#include "math/two_in_one.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

HWY_INLINE V two_in_one(V first, V second) {
  const auto rounded = [](V v) HWY_ATTR { return hn::BitCast(DU(), v) + set_bits(kHalfOfCut); };
  return hn::BitCast(D(), hn::Or(hn::And(rounded(first), set_bits(kFirstOfTwo)),
                                 hn::ShiftRight<16>(rounded(second))));
}
HWY_INLINE V first_of_two(V both) {
  return hn::BitCast(D(), hn::And(hn::BitCast(DU(), both), set_bits(kFirstOfTwo)));
}
HWY_INLINE V second_of_two(V both) {
  return hn::BitCast(D(), hn::ShiftLeft<16>(hn::BitCast(DU(), both)));
}
HWY_INLINE V2 with_rest(V both, V rest) {
  const auto with = [](V upper, VI lower) HWY_ATTR {
    return hn::BitCast(D(), hn::BitCast(DI(), upper) + hn::ShiftRight<16>(lower));
  };
  const VI bits = hn::BitCast(DI(), rest);
  return {with(first_of_two(both), bits), with(second_of_two(both), hn::ShiftLeft<16>(bits))};
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
