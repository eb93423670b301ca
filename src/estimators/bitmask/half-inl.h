// SPDX-License-Identifier: Apache-2.0
//
// Half of a slice, marched in the frame and beyond it by a vector of pixels; see bitmask.cpp.
#if defined(SSDO_BITMASK_HALF_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_HALF_INL_H_
#undef SSDO_BITMASK_HALF_INL_H_
#else
#define SSDO_BITMASK_HALF_INL_H_
#endif

#include "estimators/bitmask/extension-inl.h"
#include "estimators/bitmask/side-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The order in which slices are taken: every other one first, so that each half of them covers
/// all directions.
HWY_INLINE int slice_at(int k, int count) {
  const int firsts = (count + 1) / 2;
  return k < firsts ? 2 * k : 2 * (k - firsts) + 1;
}

/// A vector of receivers in the frame.
struct Place {
  std::ptrdiff_t index;
  int y, comb, column;
};

/// The difference of two halves, with `first` of `count` slices in one of them, is the standard
/// error of the whole times this, with the sign of the pattern's member.
HWY_INLINE float error_of_difference(const March& march, const Place& place, int first, int count) {
  const int row = (place.y + march.scene.first_y) & (Interleaving::kPeriod - 1);
  return march.pattern.half_sign(place.comb, row) * std::sqrt(float(first) * float(count - first)) /
         float(count);
}

/// Marches one half of a slice, on the side `forward` or not, in the frame and beyond it, and gives
/// the sectors that stay open. `beyond` hears of those that are hidden beyond the frame.
template <bool kOrthographic, class Seen, class Covered, class Beyond>
HWY_INLINE VU march_half(const March& march, const Receiver& p, const Half& half,
                         const Slice& slice, bool forward, const Place& place, float reach,
                         const Seen& seen, const Covered& covered, const Beyond& beyond) {
  const D d;
  const SliceSide& side = slice.sides[forward ? 0 : 1];
  const VU open = march_side<kOrthographic>(march, p, half, side, place.index, place.y,
                                            place.column, reach, seen, covered);
  if (!march.extend || hn::AllTrue(DU(), open == hn::Zero(DU()))) return open;
  const float sign = forward ? 1.0f : -1.0f;
  const Border border =
      border_along(march.scene, p, place.comb, place.column, hn::Set(d, sign * slice.dx),
                   hn::Set(d, sign * slice.dy), true);
  const VU bits = extend_side<kOrthographic>(march, p, half, border, reach, side.phase);
  beyond(border, hn::And(open, bits));
  return hn::AndNot(bits, open);
}

/// Calls `work(place, receiver, slices, reach_px)` for each vector of pixels that marches and shows
/// a surface.
template <class Work>
HWY_INLINE void for_each_receiver(const March& march, int y0, int y1, const Work& work) {
  for_each_vector(march.scene, y0, y1, [&](std::ptrdiff_t i, int y, int comb, int column) HWY_ATTR {
    const int row = (y + march.scene.first_y) & (Interleaving::kPeriod - 1);
    const std::vector<Slice>& slices = march.pattern.member(comb, row);
    if (slices.empty()) return;
    const Receiver p = load_receiver(march.scene, i, y, comb, column);
    work(Place{i, y, comb, column}, p, slices, reach_px(march.scene, p, march.radius));
  });
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
