// SPDX-License-Identifier: Apache-2.0
//
// The geometry of method bitmask for a vector of pixels, compiled once for every instruction set;
// see bitmask.cpp for the method and its symbols. Lanes are pixels that lie a pattern apart in a
// row.
#if defined(SSDO_BITMASK_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_LANES_INL_H_
#undef SSDO_BITMASK_LANES_INL_H_
#else
#define SSDO_BITMASK_LANES_INL_H_
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <cmath>

#include "estimators/bitmask/march.h"
#include "estimators/bitmask/slice_sectors.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using DI = hn::RebindToSigned<D>;
using DU = hn::RebindToUnsigned<D>;
using V = hn::Vec<D>;
using VU = hn::Vec<DU>;
using M = hn::Mask<D>;

/// Error of a height above a tangent plane, over the distance to the viewer: 4 units in the last
/// place.
constexpr float kHeightError = 2.4e-7f;

HWY_INLINE V dot2(V ax, V ay, V bx, V by) { return hn::MulAdd(ax, bx, ay * by); }
HWY_INLINE V dot3(V ax, V ay, V az, V bx, V by, V bz) {
  return hn::MulAdd(ax, bx, hn::MulAdd(ay, by, az * bz));
}

/// Error of the difference of two cosines from reciprocal_sqrt().
constexpr float kCosineError = 8e-4f;

/// 1 / sqrt(x), off by 4e-4 of it at most.
HWY_INLINE V reciprocal_sqrt(V x) {
#if HWY_TARGET == HWY_SCALAR
  return hn::Set(D(), 1.0f) / hn::Sqrt(x);  // Highway's own is off by 2e-3 here
#else
  return hn::ApproximateReciprocalSqrt(x);
#endif
}

/// The bits from `first` (0..32 or more) on.
HWY_INLINE VU bits_from(VU first) {
  const DU du;
#if HWY_TARGET == HWY_SCALAR
  return hn::IfThenElseZero(first < hn::Set(du, 32u), hn::Set(du, ~0u)
                                                          << hn::Min(first, hn::Set(du, 31u)));
#else
  return hn::Set(du, ~0u) << first;  // nothing is left of a shift by 32 or more
#endif
}

/// Columns of the picture that the lanes stand for.
HWY_INLINE V lane_columns(const Interleaving& layout, int column_phase, int column) {
  const DI di;
  constexpr int kPeriod = Interleaving::kPeriod;
  return hn::ConvertTo(D(), hn::Iota(di, 0) * hn::Set(di, kPeriod) +
                                hn::Set(di, column * kPeriod + column_phase - layout.phase()));
}

/// Where in the raster a vector of pixels is: every eighth one of row `y` from `column_phase` on,
/// of which it holds those from `column` on.
struct Place {
  std::ptrdiff_t index;
  int y, column_phase, column;
};

/// One lane's pixel that gathers.
struct Receiver {
  Place place;         ///< of all lanes
  float reach_px = 0;  ///< of all lanes: no pixel farther away can be within the radius
  V x, y;              ///< pixel
  V slope_x, slope_y;  ///< of the ray through it, or its place where the camera is orthographic
  V px, py, pz;        ///< position
  V nx, ny, nz;        ///< normal, bent to face the viewer
  V vx, vy, vz;        ///< unit, to the viewer
  V distance;          ///< to the viewer
  V facing;            ///< N.V
  /// Height of what a pixel shows above the tangent plane, along V and less what rounding may have
  /// added: depth (rise + rise_x dx + rise_y dy) + plane, for a pixel that lies (dx, dy) from this.
  V rise, rise_x, rise_y, plane;
  M valid;
};

HWY_INLINE Receiver load_receiver(const MarchScene& scene, const Place& place) {
  const D d;
  const auto [i, y, column_phase, column] = place;
  Receiver p;
  p.place = place;
  hwy::Prefetch(scene.rounding.data() + i + 4 * hn::Lanes(d));  // nothing else comes by here
  const V depth = hn::LoadU(d, scene.depth().data() + i);
  p.x = lane_columns(scene.layout, column_phase, column), p.y = hn::Set(d, float(y));
  p.nx = hn::LoadU(d, scene.nx.data() + i);
  p.ny = hn::LoadU(d, scene.ny.data() + i);
  p.nz = hn::LoadU(d, scene.nz.data() + i);
  p.valid = depth == depth;
  const V one = hn::Set(d, 1.0f), zero = hn::Zero(d);
  p.slope_x = (p.x + hn::Set(d, float(scene.first_x)) - hn::Set(d, scene.axis_x)) *
              hn::Set(d, 1 / scene.fx);
  p.slope_y =
      (hn::Set(d, scene.axis_y) - hn::Set(d, float(y + scene.first_y))) * hn::Set(d, 1 / scene.fy);
  p.pz = zero - depth;
  if (scene.orthographic) {
    p.px = p.slope_x, p.py = p.slope_y;
    p.vx = p.vy = zero, p.vz = one;
    p.rise = zero;
    p.distance = depth;
  } else {
    p.px = p.slope_x * depth, p.py = p.slope_y * depth;
    const V length =
        hn::Sqrt(hn::MulAdd(p.slope_x, p.slope_x, hn::MulAdd(p.slope_y, p.slope_y, one)));
    p.vz = one / length;
    p.vx = zero - p.slope_x * p.vz, p.vy = zero - p.slope_y * p.vz;
    p.rise = zero - length;  // N.V / facing is 1
    p.distance = depth * length;
  }
  p.facing = dot3(p.nx, p.ny, p.nz, p.vx, p.vy, p.vz);
  const V least = hn::Set(d, kLeastFacing);
  const M away = p.facing < least;
  if (!hn::AllFalse(d, away)) {
    const V lift = hn::IfThenElseZero(away, least - p.facing);
    p.nx = hn::MulAdd(lift, p.vx, p.nx);
    p.ny = hn::MulAdd(lift, p.vy, p.ny);
    p.nz = hn::MulAdd(lift, p.vz, p.nz);
    p.facing = hn::Max(p.facing, least);
  }
  const V along_view = one / p.facing;
  p.rise_x = p.nx * along_view * hn::Set(d, 1 / scene.fx);
  p.rise_y = p.ny * along_view * hn::Set(d, -1 / scene.fy);
  const V margin =
      hn::MulAdd(p.distance, hn::Set(d, kHeightError), hn::LoadU(d, scene.rounding.data() + i));
  p.plane = hn::NegMulAdd(margin, along_view, p.distance);
  return p;
}

/// Height of the surface at `depth`, (dx, dy) pixels from the receiver.
template <bool kOrthographic>
HWY_INLINE V height_above(const Receiver& p, V rise, V depth) {
  if constexpr (kOrthographic) return rise + (p.plane - depth);
  return hn::MulAdd(depth, rise, p.plane);
}

/// Distance in the picture beyond which nothing can be within `radius` of a receiver: seen from
/// the viewer, a ray at slope e from the receiver's passes it at d e / (l + e), l the length of
/// the receiver's ray per unit of depth.
HWY_INLINE float reach_px(const MarchScene& scene, const Receiver& p, float radius) {
  const D d;
  const float f = scene.fx > scene.fy ? scene.fx : scene.fy;
  if (scene.orthographic || radius > 1e18f) return radius * f;
  const V depth = hn::Zero(d) - p.pz, r = hn::Set(d, radius);
  const V slope = r * p.distance / (depth * (depth - r));
  const V all = hn::IfThenElse(depth > r, slope, hn::Set(d, 1e30f));
  return f * hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElseZero(p.valid, all)));
}

/// The number of the first sector whose point lies behind a direction with the cosine c to V. The
/// point of sector i is at i + phase; `start` is start_of_sectors(phase).
HWY_INLINE VU sector_at(V c, V start) {
  const D d;
  // Around 1.5 * 2^23 a float's unit is one, and its low bits are the whole number nearest to it.
  const V x = hn::NegMulAdd(c, hn::Set(d, SliceSectors::kPerCosine), start);
  return hn::And(hn::BitCast(DU(), x + hn::Set(d, 12582912.0f)), hn::Set(DU(), 63u));
}

HWY_INLINE V start_of_sectors(float phase) {
  return hn::Set(D(), SliceSectors::kPerCosine + 0.5f - phase);
}

HWY_INLINE VU sector_of(V v, V distance2, V start) {
  return sector_at(v * reciprocal_sqrt(distance2), start);
}

/// A point in a slice.
struct SlicePoint {
  V s, v;
};

/// Where the back is of what lies at (s, v): behind it on its own view ray.
template <bool kOrthographic>
HWY_INLINE SlicePoint back_of(const Receiver& p, V s, V v, V depth) {
  if constexpr (kOrthographic) return {s, v - depth};
  return {hn::MulAdd(depth, s, s), hn::MulAdd(depth, v - p.distance, v)};
}

/// One side of a slice, seen from the receiver. Its points have coordinates (s, v) along T and V.
struct SideFrame {
  V tx, ty, tz;          ///< unit, perpendicular to V
  V across_x, across_y;  ///< s of a point of a ray is its depth times across_x dx + across_y dy
  V slope;               ///< n_t / n_v
  V n_t;
  V start;         ///< start_of_sectors() of the side's phase
  VU above;        ///< the sectors above the tangent plane, whose number is
  VU above_count;  ///< 0..31: the last sector leads away from the viewer
};

/// The sectors that a surface hides which lies at s, `above` the receiver's tangent plane, and
/// reaches back by `depth`.
template <bool kOrthographic>
HWY_INLINE VU sectors_behind(const Receiver& p, const SideFrame& side, V s, V above, V depth,
                             float radius) {
  const D d;
  // The pixel's centre lies beside the slice. Moved into it along the receiver's tangent plane, a
  // sample keeps its height above that plane: a plane stays open whatever its tilt.
  const V v = hn::NegMulAdd(s, side.slope, above);
  const V distance2 = dot2(s, v, s, v);
  const M meets = hn::And(above > hn::Zero(d), distance2 <= hn::Set(d, radius * radius));
  const VU from = sector_of(v, distance2, side.start);
  const SlicePoint back = back_of<kOrthographic>(p, s, v, depth);
  const VU to = sector_of(back.v, dot2(back.s, back.v, back.s, back.v), side.start);
  return hn::IfThenElseZero(hn::RebindMask(DU(), meets),
                            hn::AndNot(bits_from(to), bits_from(from)));
}

/// The frame of a slice at a receiver: T, the normal's share in it, and the weight that makes
/// slices which are uniform in the picture uniform around V.
struct SliceFrame {
  V tx, ty, tz, n_t, weight;
};

HWY_INLINE SliceFrame slice_frame(const MarchScene& scene, const Receiver& p, const Slice& slice) {
  const D d;
  const V ex = hn::Set(d, slice.dx / scene.fx), ey = hn::Set(d, -slice.dy / scene.fy);
  const V along = dot2(ex, ey, p.vx, p.vy);
  const V tx = hn::NegMulAdd(along, p.vx, ex), ty = hn::NegMulAdd(along, p.vy, ey),
          tz = hn::Zero(d) - along * p.vz;
  SliceFrame f;
  f.weight = hn::Set(d, 1.0f) / dot3(tx, ty, tz, tx, ty, tz);
  const V scale = hn::Sqrt(f.weight);
  f.tx = tx * scale, f.ty = ty * scale, f.tz = tz * scale;
  // The weight has the unit of f^2; only ratios matter.
  f.n_t = dot3(p.nx, p.ny, p.nz, f.tx, f.ty, f.tz);
  return f;
}

/// The side along the slice's direction, where `forward`, or against it.
HWY_INLINE SideFrame side_frame(const MarchScene& scene, const Receiver& p, const SliceFrame& f,
                                bool forward, float phase) {
  const D d;
  const DU du;
  const auto turn = [&](V v) HWY_ATTR { return forward ? v : hn::Zero(d) - v; };
  SideFrame side;
  side.tx = turn(f.tx), side.ty = turn(f.ty), side.tz = turn(f.tz);
  side.n_t = turn(f.n_t);
  side.across_x = side.tx * hn::Set(d, 1 / scene.fx);
  side.across_y = side.ty * hn::Set(d, -1 / scene.fy);
  side.slope = side.n_t / p.facing;
  // In the slice the tangent plane leads away from V by pi/2 more than the normal does. Points
  // that rounding could lift above it do not count, nor does a sector that lies more below it than
  // above: its integral is negative.
  const V cosine =
      hn::NegMulAdd(side.n_t, reciprocal_sqrt(dot2(side.n_t, p.facing, side.n_t, p.facing)),
                    hn::Set(d, kCosineError));
  const V last_above = start_of_sectors(phase > 0.5f ? phase : 0.5f);
  side.above_count = hn::Min(sector_at(cosine, last_above), hn::Set(du, 31u));
  side.start = start_of_sectors(phase);
  side.above = hn::Not(bits_from(side.above_count));
  return side;
}

/// Calls `work(place)` for each vector of pixels of a part of the raster that shows a surface;
/// pixels beside the part may be among its lanes.
template <class Work>
HWY_INLINE void for_each_vector(const MarchScene& scene, const Window& part, const Work& work) {
  const D d;
  const Interleaving& layout = scene.layout;
  const int lanes = int(hn::Lanes(d));
  const int begin = ((part.x0 + layout.phase()) >> Interleaving::kShift) & -lanes,
            end = ((part.x1 - 1 + layout.phase()) >> Interleaving::kShift) + 1;
  for (int y = part.y0; y < part.y1; ++y) {
    for (int column_phase = 0; column_phase < Interleaving::kPeriod; ++column_phase) {
      for (int column = begin; column < end; column += lanes) {
        const std::ptrdiff_t i = layout.index(y, column_phase, column);
        const V depth = hn::LoadU(d, scene.depth().data() + i);
        if (!hn::AllFalse(d, depth == depth)) work(Place{i, y, column_phase, column});
      }
    }
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
