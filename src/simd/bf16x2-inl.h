// SPDX-License-Identifier: Apache-2.0
//
// math/bf16x2.h for vectors; compiled once for every instruction set.
#if defined(SSDO_SIMD_BF16X2_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_SIMD_BF16X2_INL_H_
#undef SSDO_SIMD_BF16X2_INL_H_
#else
#define SSDO_SIMD_BF16X2_INL_H_
#endif

#include "math/bf16x2.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

HWY_INLINE V pack_bf16x2(V first, V second) {
  const auto rounded = [](V v)
                           HWY_ATTR { return hn::BitCast(DU(), v) + set_bits(kRoundToUpperHalf); };
  return hn::BitCast(D(), hn::Or(hn::And(rounded(first), set_bits(kUpperHalf)),
                                 hn::ShiftRight<16>(rounded(second))));
}
HWY_INLINE V unpack_bf16_first(V both) {
  return hn::BitCast(D(), hn::And(hn::BitCast(DU(), both), set_bits(kUpperHalf)));
}
HWY_INLINE V unpack_bf16_second(V both) {
  return hn::BitCast(D(), hn::ShiftLeft<16>(hn::BitCast(DU(), both)));
}
HWY_INLINE V2 unpack_bf16x2_exact(V both, V rest) {
  const auto with = [](V upper, VI lower) HWY_ATTR {
    return hn::BitCast(D(), hn::BitCast(DI(), upper) + hn::ShiftRight<16>(lower));
  };
  const VI bits = hn::BitCast(DI(), rest);
  return {with(unpack_bf16_first(both), bits),
          with(unpack_bf16_second(both), hn::ShiftLeft<16>(bits))};
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
