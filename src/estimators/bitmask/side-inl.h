// SPDX-License-Identifier: Apache-2.0
//
// The march of a vector of pixels along one side of a slice, in the frame and beyond its border;
// see bitmask.cpp.
#if defined(SSDO_BITMASK_SIDE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_SIDE_INL_H_
#undef SSDO_BITMASK_SIDE_INL_H_
#else
#define SSDO_BITMASK_SIDE_INL_H_
#endif

#include <hwy/cache_control.h>

#include "estimators/bitmask/extension-inl.h"
#include "estimators/bitmask/further-inl.h"
#include "estimators/bitmask/piece-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The slice to march as the k-th of `count`: even ones first, then odd ones, so that each half of
/// them covers all directions evenly.
HWY_INLINE int slice_at(int k, int count) {
  const int firsts = (count + 1) / 2;
  return k < firsts ? 2 * k : 2 * (k - firsts) + 1;
}

/// The standard error of the mean over `count` slices, divided by the difference between the means
/// of its two halves, of which one has `first` slices. Signed as SlicePattern::half_sign() is.
HWY_INLINE float error_of_difference(const March& march, const Place& place, int first, int count) {
  const int row = (place.y + march.scene.first_y) & (Interleaving::kPeriod - 1);
  return march.pattern.half_sign(place.column_phase, row) *
         std::sqrt(float(first) * float(count - first)) / float(count);
}

/// Fetches what the next vector of receivers reads, beside what these read at index `i`: the
/// processor's own prefetcher cannot follow as many streams. A lambda would not do, as g++ 12 drops
/// calls of what does nothing else.
HWY_INLINE void prefetch_next(const InterleavedPlane& plane, std::ptrdiff_t i) {
  hwy::Prefetch(plane.data() + i + 2 * kLanes - 1);
}

/// Marches one side over the raster, near to far, and returns the sectors that stay open. Calls
/// `on_met(layer, index, step, sectors)` for every solid that is met, with the sectors in which it
/// is the first.
template <bool kOrthographic, class Met>
HWY_INLINE VU march_raster(const March& march, const MarchReceiver& p, const SideFrame& side,
                           const std::vector<SliceStep>& steps, const Met& on_met) {
  const MarchScene& scene = march.scene;
  const MarchLayer& seen = scene.layers.front();
  const int layers = int(scene.layers.size());
  const int height = scene.layout.height(), columns = scene.layout.columns();
  VU open = side.open;
  Front before{nullptr, 0, set(0)};
  for (const SliceStep& step : steps) {
    const int row = p.place.y + step.row, first = p.place.column + step.column_shift;
    if (step.inner_px > p.reach_px || row < 0 || row >= height || first >= columns ||
        first + kLanes <= 0)
      break;
    const std::ptrdiff_t i = p.place.index + step.offset;
    prefetch_next(seen.depth, i), prefetch_next(seen.thickness, i), prefetch_next(scene.tilt, i);
    const V dx = set(step.dx), dy = set(step.dy);
    const V rise = hn::MulAdd(dx, p.rise_x, hn::MulAdd(dy, p.rise_y, p.rise)),
            across = dot(V2{dx, dy}, side.across);
    const auto meet = [&](int layer, V depth, V above, const auto& piece) HWY_ATTR {
      const InterleavedPlane& thicknesses = scene.layers[std::size_t(layer)].thickness;
      if (layer > 0) prefetch_next(thicknesses, i);
      const V s = kOrthographic ? across : depth * across, thickness = load(thicknesses, i);
      VU bits = step.inner == step.outer
                    ? sectors_behind<kOrthographic>(p, side, s, above, thickness, march.radius)
                    : sectors_behind_piece<kOrthographic>(p, side, piece(), s, above, thickness,
                                                          march.radius);
      if (march.may_be_thin && layer == 0 && before.step) {
        bits = hn::Or(bits, sectors_between<kOrthographic>(march, p, side, before,
                                                           {&step, i, depth}, above > set(0)));
      }
      on_met(layer, i, step, hn::And(open, bits));
      open = hn::AndNot(bits, open);
    };
    const V depth = load(seen.depth, i), above = height_above<kOrthographic>(p, rise, depth);
    if (any(above > set(0))) {
      meet(0, depth, above, [&]() HWY_ATTR {
        return piece_at<kOrthographic>(scene, p, side, step, i, depth, rise, across);
      });
    }
    before = {&step, i, depth};
    for (int k = 1; k < layers; ++k) {
      const MarchLayer& layer = scene.layers[std::size_t(k)];
      prefetch_next(layer.depth, i);
      const V front = load(layer.depth, i),
              front_above = height_above<kOrthographic>(p, rise, front);
      if (!any(front_above > set(0))) continue;
      meet(k, front, front_above, [&]() HWY_ATTR {
        return piece_facing_viewer<kOrthographic>(p, side, step, front, rise, across);
      });
    }
  }
  return open;
}

/// The same over the raster, what further views show, and beyond the raster's border. `on_further`
/// is told of what rays meet there (further-inl.h); `on_beyond(border, sectors)` is called with the
/// sectors that are first hidden beyond the border.
template <bool kOrthographic, class Met, class Further, class Beyond>
HWY_INLINE VU march_side(const March& march, const MarchReceiver& p, const SideFrame& side,
                         const Slice& slice, bool forward, const Met& on_met,
                         const Further& on_further, const Beyond& on_beyond) {
  VU open = march_raster<kOrthographic>(march, p, side, slice.sides[forward ? 0 : 1].steps, on_met);
  if (march.further && !none(open))
    open = hn::AndNot(sectors_of_further(march, p, side, open, on_further), open);
  if (!march.extend || none(open)) return open;
  const float sign = forward ? 1.0f : -1.0f;
  const Border border =
      border_along(march.scene, p, set(sign * slice.dx), set(sign * slice.dy), true);
  const VU bits = extend_side<kOrthographic>(march, p, side, border);
  on_beyond(border, hn::And(open, bits));
  return hn::AndNot(bits, open);
}

/// Calls `work(receiver, slices)` for each vector of pixels in a part of the raster that shows a
/// surface and whose member of the pattern has slices.
template <class Work>
HWY_INLINE void for_each_receiver(const March& march, const Window& part, const Work& work) {
  for_each_vector(march.scene, part, [&](const Place& place) HWY_ATTR {
    const int row = (place.y + march.scene.first_y) & (Interleaving::kPeriod - 1);
    const std::vector<Slice>& slices = march.pattern.member(place.column_phase, row);
    if (slices.empty()) return;
    MarchReceiver p = load_receiver(march.scene, place);
    p.reach_px = reach_px(march.scene, p, march.radius);
    work(p, slices);
  });
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
