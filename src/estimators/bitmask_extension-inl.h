// SPDX-License-Identifier: Apache-2.0
//
// Surfaces that go on beyond the frame, for a vector of pixels; see bitmask.cpp.
#if defined(SSDO_BITMASK_EXTENSION_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_EXTENSION_INL_H_
#undef SSDO_BITMASK_EXTENSION_INL_H_
#else
#define SSDO_BITMASK_EXTENSION_INL_H_
#endif

#include <hwy/highway.h>

#include "estimators/bitmask_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Where lanes leave the frame along (dx, dy), a unit vector in pixels.
struct Border {
  hn::Vec<DI> index;  ///< of the last pixel, in BorderValues
  V distance_px;
};

/// Columns of the picture that the lanes stand for.
HWY_INLINE V lane_columns(const Interleaving& layout, int comb, int column) {
  const DI di;
  constexpr int kPeriod = Interleaving::kPeriod;
  return hn::ConvertTo(D(), hn::Iota(di, 0) * hn::Set(di, kPeriod) +
                                hn::Set(di, column * kPeriod + comb - layout.phase()));
}

HWY_INLINE Border border_along(const Interleaving& layout, V dx, V dy, V x, V y) {
  const D d;
  const int w = layout.width(), h = layout.height();
  const V zero = hn::Zero(d), right = hn::Set(d, float(w - 1)), bottom = hn::Set(d, float(h - 1)),
          tiny = hn::Set(d, 1e-9f);
  const M rightwards = dx > zero, downwards = dy > zero;
  const V to_side = hn::IfThenElse(rightwards, right - x, x) / hn::Max(hn::Abs(dx), tiny),
          to_end = hn::IfThenElse(downwards, bottom - y, y) / hn::Max(hn::Abs(dy), tiny);
  const V t = hn::Max(hn::Min(to_side, to_end), zero);
  const V edge_x = hn::Clamp(hn::MulAdd(t, dx, x), zero, right),
          edge_y = hn::Clamp(hn::MulAdd(t, dy, y), zero, bottom);
  const V at_end = edge_x + hn::IfThenElseZero(downwards, hn::Set(d, float(w))),
          at_side = edge_y + hn::Set(d, 2.0f * float(w)) +
                    hn::IfThenElseZero(rightwards, hn::Set(d, float(h)));
  return {hn::NearestInt(hn::IfThenElse(to_side < to_end, at_side, at_end)), t};
}

/// How far a surface goes on beyond the frame, in heights of the frame at its depth.
constexpr float kExtension = 3;

/// The piece of surface in a slice that goes on beyond the frame, from where it leaves it to where
/// it ends.
struct Extension {
  V s, v, above, distance2;  ///< at the border
  V end_s, end_v, end_above;
  V depth;  ///< from front to back at the border
  M exists;
};

/// The surface at the frame's border goes on beyond it as its tangent plane does, within the
/// radius and for as many of its own widths.
template <bool kOrthographic>
HWY_INLINE Extension extend(const March& march, const Receiver& p, const Half& half,
                            const Border& border, float reach, float widths) {
  const D d;
  const MarchScene& scene = march.scene;
  const V zero = hn::Zero(d);
  const auto gather = [&](const BorderValues& values)
                          HWY_ATTR { return hn::GatherIndex(d, values.data(), border.index); };
  const V qx = gather(scene.border_position[0]), qy = gather(scene.border_position[1]),
          qz = gather(scene.border_position[2]);
  Extension e;
  e.above = dot3(qx, qy, qz, p.nx, p.ny, p.nz) - p.plane;
  e.s = dot3(qx, qy, qz, half.tx, half.ty, half.tz);
  if constexpr (kOrthographic) e.s = e.s - half.origin;
  e.v = hn::MulSub(e.above, p.inverse_facing, e.s * half.slope);
  e.distance2 = dot2(e.s, e.v, e.s, e.v);
  const V radius2 = hn::Set(d, march.radius * march.radius);
  e.exists = hn::And(e.distance2 < radius2, border.distance_px <= hn::Set(d, reach));
  if (hn::AllFalse(d, e.exists)) return e;

  // The line in which the tangent plane cuts the slice, away from the frame.
  const V mx = gather(scene.border_normal[0]), my = gather(scene.border_normal[1]),
          mz = gather(scene.border_normal[2]);
  V line_s = dot3(mx, my, mz, p.vx, p.vy, p.vz);
  V line_v = zero - dot3(mx, my, mz, half.tx, half.ty, half.tz);
  const V scale = hn::Set(d, 1.0f) / hn::Sqrt(dot2(line_s, line_v, line_s, line_v));
  line_s = line_s * scale, line_v = line_v * scale;
  const V frame = hn::Set(d, kExtension * float(scene.layout.height()) / scene.fy);
  V length = kOrthographic ? frame : zero - frame * qz;
  const V thickness = gather(scene.border_thickness);
  length = hn::Min(length, thickness * hn::Set(d, widths));
  e.depth = thickness;
  if constexpr (!kOrthographic) {
    const V distance = hn::Sqrt(dot3(qx, qy, qz, qx, qy, qz));
    e.depth = hn::Min(thickness / distance, hn::Set(d, kEndlessShare));
  }
  if (march.radius < 1e18f) {
    const V along = dot2(e.s, e.v, line_s, line_v);
    length = hn::Min(length, hn::Sqrt(hn::MulAdd(along, along, radius2 - e.distance2)) - along);
  }
  e.end_s = hn::MulAdd(length, line_s, e.s), e.end_v = hn::MulAdd(length, line_v, e.v);
  e.end_above = dot2(half.n_t, p.facing, e.end_s, e.end_v);
  return e;
}

/// The sectors that it hides, and those that the last pixel before it hides.
template <bool kOrthographic>
HWY_INLINE VU extend_side(const March& march, const Receiver& p, const Half& half,
                          const Border& border, float reach, float phase) {
  const D d;
  const DU du;
  const V zero = hn::Zero(d), all = hn::Set(d, kSectors);
  const Extension e = extend<kOrthographic>(march, p, half, border, reach, 1e9f);
  if (hn::AllFalse(d, e.exists)) return hn::Zero(du);
  const V here = hn::IfThenElse(e.above > zero, sectors_of(half, e.s, e.v, e.distance2), all);
  const V end_distance2 = dot2(e.end_s, e.end_v, e.end_s, e.end_v);
  V there = sectors_of(half, e.end_s, e.end_v, end_distance2);
  // The far end of a plane lies on the horizon but for rounding.
  const M end_rises = e.end_above > hn::Sqrt(end_distance2) * hn::Set(d, 1e-5f);
  there = hn::IfThenElse(end_rises, there, all);
  there = hn::IfThenZeroElse(e.end_s < zero, there);  // it leans across the view ray
  const float to_first = 0.5f - phase;
  const V first = hn::Set(d, to_first);
  const VU from = nearest_whole(hn::Min(here, there) + first),
           to = nearest_whole(hn::Max(here, there) + first);
  const VU beyond =
      hn::IfThenElseZero(hn::RebindMask(du, e.exists), hn::AndNot(bits_from(to), bits_from(from)));
  // The border is a sample too: the last step may be far from it.
  return hn::Or(beyond, sectors_behind<kOrthographic>(p, half, e.s, e.above, e.depth, march.radius,
                                                      to_first));
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
