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

#include <span>

#include "estimators/bitmask/border/extension-inl.h"
#include "estimators/bitmask/other_views-inl.h"
#include "estimators/bitmask/overview-inl.h"
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

/// Marches one side over what is sampled, near to far, and returns which of the `open` sectors stay
/// open. Calls `on_met(layer, index, step, sectors)` for every solid that is met, with the sectors
/// in which it is the first.
template <bool kOrthographic, class Met>
HWY_INLINE VU march_steps(const March& march, const MarchReceiver& p, const SideFrame& side,
                          const Sampled& from, std::span<const SliceStep> steps, VU open,
                          const Met& on_met) {
  const MarchPlanes& planes = from.planes;
  const MarchLayer& seen = planes.layers.front();
  const int layers = int(planes.layers.size());
  Front before{nullptr, 0, set(0)};
  for (const SliceStep& step : steps) {
    const int row = from.row + step.row, first = from.column + step.column_shift;
    if (step.inner_px > p.reach_px || row < 0 || row >= from.rows || first >= from.columns ||
        first + kLanes <= 0)
      break;
    const std::ptrdiff_t i = from.index + step.offset;
    prefetch_next(seen.depth, i), prefetch_next(seen.thickness, i), prefetch_next(planes.tilt, i);
    const V dx = set(step.dx), dy = set(step.dy);
    const V rise = hn::MulAdd(dx, p.rise_x, hn::MulAdd(dy, p.rise_y, p.rise)),
            across = dot(V2{dx, dy}, side.across);
    const auto meet = [&](int layer, V depth, V above, const auto& piece) HWY_ATTR {
      const InterleavedPlane& thicknesses = planes.layers[std::size_t(layer)].thickness;
      if (layer > 0) prefetch_next(thicknesses, i);
      const V s = kOrthographic ? across : depth * across, thickness = load(thicknesses, i);
      VU bits = step.inner == step.outer
                    ? sectors_behind<kOrthographic>(p, side, s, above, thickness, march.radius)
                    : sectors_behind_piece<kOrthographic>(p, side, piece(), s, above, thickness,
                                                          march.radius);
      // The solids of a slice stand a little aside of those of the frame: what is out of the reach
      // of a lane would count where the other lanes march on.
      if (march.radius < kInfiniteLength) {
        const M within_reach = set(step.inner_px) <= p.own_reach_px;
        bits = hn::IfThenElseZero(hn::RebindMask(DU(), within_reach), bits);
      }
      if (march.may_be_thin && layer == 0 && before.step) {
        bits = hn::Or(bits, sectors_between<kOrthographic>(march, planes, p, side, before,
                                                           {&step, i, depth}, above > set(0)));
      }
      on_met(layer, i, step, hn::And(open, bits));
      open = hn::AndNot(bits, open);
    };
    const V depth = load(seen.depth, i), above = height_above<kOrthographic>(p, rise, depth);
    if (any(above > set(0))) {
      meet(0, depth, above, [&]() HWY_ATTR {
        return piece_at<kOrthographic>(planes, p, side, step, i, depth, rise, across);
      });
    }
    before = {&step, i, depth};
    for (int k = 1; k < layers; ++k) {
      const MarchLayer& layer = planes.layers[std::size_t(k)];
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

/// march_steps() over the raster, then over the overview of the frame around it. `on_met` is also
/// told which of the two shows the solid.
template <bool kOrthographic, class Met>
HWY_INLINE VU march_frame(const March& march, const MarchReceiver& p, const SideFrame& side,
                          const SliceSide& way, const Met& on_met) {
  const std::span<const SliceStep> steps = way.steps;
  const auto on_met_in = [&](bool far) HWY_ATTR {
    return [&on_met, far](int layer, std::ptrdiff_t i, const SliceStep& step, VU bits)
               HWY_ATTR { on_met(far, layer, i, step, bits); };
  };
  const VU open =
      march_steps<kOrthographic>(march, p, side, in_raster(march, p.place),
                                 steps.first(way.near_steps), side.open, on_met_in(false));
  if (!march.far || none(open)) return open;
  return march_steps<kOrthographic>(march, p, side, in_overview(march, p.place),
                                    steps.subspan(way.near_steps), open, on_met_in(true));
}

/// The sectors that are hidden beyond the border of the frame. Calls `on_beyond(far, border,
/// sectors)` with those of them that are open; `far`: the border is that of the overview.
template <bool kOrthographic, class Beyond>
HWY_INLINE VU hidden_beyond(const March& march, const MarchReceiver& p, const SideFrame& side,
                            float dx, float dy, VU open, const Beyond& on_beyond) {
  const Border border = border_along(march.scene, p, set(dx), set(dy), true);
  VU bits = extend_side<kOrthographic>(march, p, side, border);
  if (!march.far) {
    on_beyond(false, border, hn::And(open, bits));
    return bits;
  }
  // Up to from_px, the border of the raster is that of the frame.
  const M is_near = border.distance_px <= set(march.far->raster.from_px);
  const VU here = hn::VecFromMask(DU(), hn::RebindMask(DU(), is_near));
  bits = hn::And(bits, here);
  on_beyond(false, border, hn::And(open, bits));
  if (none(hn::Not(here))) return bits;
  const March far = march_in_overview(march);
  const MarchReceiver far_p = in_overview_pixels(march, p);
  const Border far_border = border_along(far.scene, far_p, set(dx), set(dy), false);
  const VU far_bits = hn::AndNot(
      here, extend_side<kOrthographic>(far, far_p, in_overview_pixels(side), far_border));
  on_beyond(true, far_border, hn::And(open, far_bits));
  return hn::Or(bits, far_bits);
}

/// Marches one side of a slice over the frame, then asks other views, then continues surfaces
/// beyond the frame's border; returns the sectors that stay open. `on_other_views` gets what rays
/// meet in other views (other_views-inl.h); `on_beyond(far, border, sectors)` gets the sectors that
/// are first hidden beyond the border, of the raster or of the overview.
template <bool kOrthographic, class Met, class OtherViews, class Beyond>
HWY_INLINE VU march_side(const March& march, const MarchReceiver& p, const SideFrame& side,
                         const Slice& slice, bool forward, const Met& on_met,
                         const OtherViews& on_other_views, const Beyond& on_beyond) {
  VU open = march_frame<kOrthographic>(march, p, side, slice.sides[forward ? 0 : 1], on_met);
  if (march.other_views && !none(open))
    open = hn::AndNot(sectors_hidden_in_other_views(march, p, side, open, on_other_views), open);
  if (!march.extend || none(open)) return open;
  const float sign = forward ? 1.0f : -1.0f;
  const VU bits = hidden_beyond<kOrthographic>(march, p, side, sign * slice.dx, sign * slice.dy,
                                               open, on_beyond);
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
    p.own_reach_px = own_reach_px(march.scene, p, march.radius);
    work(p, slices);
  });
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
