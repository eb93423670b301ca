// SPDX-License-Identifier: Apache-2.0
//
// What the solids that a march meets send, for a vector of pixels (see bounce.cpp); compiled once
// for every instruction set.
#if defined(SSDO_BITMASK_MET_SENDERS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_MET_SENDERS_INL_H_
#undef SSDO_BITMASK_MET_SENDERS_INL_H_
#else
#define SSDO_BITMASK_MET_SENDERS_INL_H_
#endif

#include <cstddef>
#include <cstdint>
#include <glm/gtc/constants.hpp>

#include "estimators/bitmask/jobs.h"
#include "estimators/bitmask/lanes-inl.h"
#include "estimators/bitmask/side-inl.h"
#include "simd/by_lane-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Whether the surface at `q`, `step` away from the receiver, faces it with the side that the
/// camera sees: in the receiver's pixel, the tangent plane of the surface lies behind the receiver.
template <bool kOrthographic>
HWY_INLINE M faces(const MarchPlanes& planes, std::ptrdiff_t q, const SliceStep& step,
                   const MarchReceiver& p) {
  const V p_depth = set(0) - p.position.z, nearer = nearer_over(planes, q, step);
  return load(planes.depth(), q) > p_depth - (kOrthographic ? nearer : p_depth * nearer);
}

/// The pixels at index `q` that a march meets, a step away from the receivers.
struct MetPixels {
  const MarchPlanes& planes;
  std::ptrdiff_t q;
  const SliceStep& step;
};

/// The vectors from the receivers to the fronts of the solids of layer `layer` in these pixels.
template <bool kOrthographic>
HWY_INLINE V3 way_to(const MarchScene& scene, const MarchReceiver& p, const MetPixels& met,
                     int layer = 0) {
  const float dx = met.step.dx, dy = met.step.dy;
  const V depth = load(met.planes.layers[std::size_t(layer)].depth, met.q);
  V3 there{p.slope_x + set(dx / scene.fx), p.slope_y - set(dy / scene.fy), set(-1)};
  if constexpr (kOrthographic)
    there.z = hn::Neg(depth);
  else
    there = there * depth;
  return there - p.position;
}

/// The part of the light sent by pixels that the march gathers: all but the part that rays gather
/// (rays/emitters.h). `seen`: the lanes where the side that the camera sees faces the receiver.
/// `of_all`: what the facing side sends of all lights.
template <bool kOrthographic>
HWY_INLINE V3 without_emitted(const BounceJob& job, const MarchReceiver& p, const MetPixels& met,
                              M seen, const V3& sent, const V3& of_all) {
  const MarchScene& scene = job.march.scene;
  const V light = luminance(of_all), above = light - set(job.emitters->level);
  // An endless solid has no back that rays go to.
  const V thickness = load(met.planes.layers.front().thickness, met.q);
  const M ends = thickness < set(kOrthographic ? kInfiniteThickness : kInfiniteThicknessRatio),
          exceeds = hn::And(above > set(0), hn::Or(seen, ends));
  if (!any(exceeds)) return sent;
  const V3 way = way_to<kOrthographic>(scene, p, met);
  const V far = dot(way, way) * set(glm::pi<float>()) * above;
  const V by_rays = above * far / (far + set(job.emitters->power));
  return sent * hn::IfThenElse(exceeds, set(1) - by_rays / light, set(1));
}

/// The pixels of the overview that stand for pixels of the raster.
HWY_INLINE OverviewPixels in_overview(const BounceJob& job, const OverviewPixels& at) {
  const MarchScene& scene = job.march.scene;
  const OverviewRaster& far = job.overview->raster;
  const auto block = [](VI pixel, int first, int far_first, int size) HWY_ATTR {
    const VI of_frame = hn::ShiftRight<Interleaving::kShift>(pixel + set_int(first));
    return hn::Clamp(of_frame - set_int(far_first), set_int(0), set_int(size - 1));
  };
  return {block(at.x, scene.first_x, far.first_x, far.width),
          block(at.y, scene.first_y, far.first_y, far.height)};
}

HWY_INLINE V3 gather(const InterleavedVectors& color, VI at) {
  return {gather(color[0].data(), at), gather(color[1].data(), at), gather(color[2].data(), at)};
}

/// The radiance that solids send, and the lanes in which the frame shows the sending side and it is
/// known that the solid is there.
struct Sent {
  V3 radiance;
  M shown;
};

/// Whether a ray along `way` meets the side that the camera sees of the tangent planes in the
/// pixels `at`, whose tilts are at `index`.
HWY_INLINE M sees_front(const MarchScene& scene, const InterleavedPlane& tilts, VI index,
                        const OverviewPixels& at, const V3& way) {
  const V tilt = gather(tilts.data(), index);
  const V axis_x = set(scene.axis_x - float(scene.first_x)),
          axis_y = set(scene.axis_y - float(scene.first_y));
  const V2 slope{(hn::ConvertTo(D(), at.x) - axis_x) * set(1 / scene.fx),
                 (axis_y - hn::ConvertTo(D(), at.y)) * set(1 / scene.fy)};
  const V3 normal =
      normal_of_tilt(scene, {unpack_bf16_first(tilt), unpack_bf16_second(tilt)}, slope);
  return dot(normal, way) < set(0);
}

/// The lanes whose solids, in these columns of a row, are known to be there and not only guessed.
HWY_INLINE M are_known(const SolidLayer& solids, int row, VI column) {
  alignas(64) std::int32_t columns[kLanes];
  hn::Store(column, DI(), columns);
  return by_lane([&](int lane) HWY_ATTR {
           return solids.provenance(columns[lane], row) == Provenance::guessed ? 0.0f : 1.0f;
         }) > set(0);
}

/// What the solids of layer `layer` in the pixels `met` send, in the lanes of `bits`: the radiance
/// of the pixels that show these solids, or 0.
template <bool kOrthographic>
HWY_INLINE Sent sent_behind(const BounceJob& job, bool far, int layer, const MarchReceiver& p,
                            const MetPixels& met, VU bits) {
  const DI di;
  const VI zero = set_int(0);
  const March& march = job.march;
  const MarchScene& scene = far ? march.far->scene : march.scene;
  const Interleaving& layout = march.scene.layout;
  const SolidLayer& solids =
      (far ? job.overview->solids : job.solids).behind[std::size_t(layer - 1)];
  const Sampled at = far ? in_overview(march, p.place) : in_raster(march, p.place);
  const VI column =
      far ? hn::Iota(di, at.column + met.step.column_shift)
          : hn::ConvertTo(di, lane_columns(layout, p.place.column_phase, p.place.column)) +
                set_int(int(met.step.dx));
  const auto is_met = hn::BitCast(di, bits) != zero;
  const VI column_met = hn::IfThenElseZero(is_met, column);
  const int row = at.row + met.step.row;
  const VI sender = hn::GatherIndex(di, &solids.sender(0, row), column_met);
  const auto shown = hn::AndNot(sender < zero, is_met);
  const OverviewPixels from = pixels_of(hn::IfThenElseZero(shown, sender), solids.sender.width);
  const VI index = far ? index_of(job.overview->raster, from) : index_of(layout, from);
  V3 sent = gather(far ? job.far->sent : *job.light, index);
  if (!far && job.overview) {
    const auto lit = hn::And(from.y > set_int(job.lit.y0 - 1), from.y < set_int(job.lit.y1));
    const VI beyond = index_of(job.overview->raster, in_overview(job, from));
    sent = if_then_else(hn::RebindMask(D(), lit), sent, gather(job.far->sent, beyond));
  }
  const M known = hn::RebindMask(D(), shown);
  if (job.two_sided) {
    const V3 way = way_to<kOrthographic>(scene, p, met, layer);
    const M front = sees_front(scene, met.planes.tilt, index, from, way);
    sent = if_then_else(front, front_of(sent), back_of(sent));
  }
  // A guessed solid sends as the surface does that it may belong to, but other views know better.
  const bool asks = job.march.other_views;
  return {if_then_else_zero(known, sent),
          asks ? hn::And(known, are_known(solids, row, column_met)) : known};
}

/// What the solids of layer 0 in the pixels `met` send.
template <bool kOrthographic>
HWY_INLINE Sent sent_by_front(const BounceJob& job, bool far, const MarchReceiver& p,
                              const MetPixels& met) {
  const InterleavedVectors& sending = far ? job.far->sent : *job.light;
  for (const InterleavedPlane& channel : sending) prefetch_next(channel, met.q);
  const V3 sent = load(sending, met.q);
  if (!job.two_sided && !job.emitters && !job.march.other_views) return {sent, p.valid};
  const M seen = faces<kOrthographic>(met.planes, met.q, met.step, p);
  const auto from_side = [&](const V3& both) HWY_ATTR {
    return job.two_sided ? if_then_else(seen, front_of(both), back_of(both)) : both;
  };
  if (!job.emitters) return {from_side(sent), seen};
  const V3 of_all = load(far ? job.far_of_all->sent : *job.of_all, met.q);
  return {without_emitted<kOrthographic>(job, p, met, seen, from_side(sent), from_side(of_all)),
          seen};
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
