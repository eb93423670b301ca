// SPDX-License-Identifier: Apache-2.0
//
// The geometry of method bitmask for a vector of pixels, compiled once for every instruction set;
// see bitmask.cpp for the method and its symbols. Lanes are pixels that lie four apart in a row.
#if defined(SSDO_BITMASK_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_LANES_INL_H_
#undef SSDO_BITMASK_LANES_INL_H_
#else
#define SSDO_BITMASK_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <cmath>

#include "estimators/bitmask_march.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<float, 16>;
using DI = hn::RebindToSigned<D>;
using DU = hn::RebindToUnsigned<D>;
using V = hn::Vec<D>;
using VU = hn::Vec<DU>;
using M = hn::Mask<D>;

constexpr float kPi = 3.14159265f;
constexpr float kSectors = 32;  ///< of a side
/// Least cosine between normal and view: a smooth normal that leans away from the viewer is bent
/// back to here. A plane tilted by 89.9 degrees has 0.0017.
constexpr float kLeastFacing = 1e-3f;
/// Error of a dot product of a position and a unit vector, over the position's length: 4 units in
/// the last place.
constexpr float kDotError = 2.4e-7f;

HWY_INLINE V dot2(V ax, V ay, V bx, V by) { return hn::MulAdd(ax, bx, ay * by); }
HWY_INLINE V dot3(V ax, V ay, V az, V bx, V by, V bz) {
  return hn::MulAdd(ax, bx, hn::MulAdd(ay, by, az * bz));
}

/// theta - sin theta cos theta, theta in 0..pi, from both. Over sin^3 theta it is smooth; a
/// polynomial in the cosine, off by 4.4e-5 at most.
HWY_INLINE V cap_measure(V sine, V cosine) {
  const D d;
  const V c = hn::Abs(cosine);
  V p = hn::MulAdd(hn::Set(d, -0.4309997f), c, hn::Set(d, 1.4231141f));
  p = hn::MulAdd(p, c, hn::Set(d, -2.1847912f));
  p = hn::MulAdd(p, c, hn::Set(d, 2.2808718f));
  p = hn::MulAdd(p, c, hn::Set(d, -1.995549f));
  p = hn::MulAdd(p, c, hn::Set(d, 1.5707532f));
  const V g = sine * sine * sine * p;
  return hn::IfThenElse(cosine < hn::Zero(d), hn::Set(d, kPi) - g, g);
}

/// acos on 0..1 (Abramowitz and Stegun 4.4.45), off by 7e-5 at most.
HWY_INLINE V arc_cosine(V c) {
  const D d;
  V p = hn::MulAdd(hn::Set(d, -0.0187293f), c, hn::Set(d, 0.0742610f));
  p = hn::MulAdd(p, c, hn::Set(d, -0.2121144f));
  p = hn::MulAdd(p, c, hn::Set(d, 1.5707288f));
  return hn::Sqrt(hn::Max(hn::Set(d, 1.0f) - c, hn::Zero(d))) * p;
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

/// The whole number nearest to x, 0 for what is negative, for x up to 63: between 2^23 and 2^24 a
/// float's unit is one and its low bits are the number.
HWY_INLINE VU nearest_whole(V x) {
  const D d;
  const DU du;
  const V binade = hn::Set(d, 8388608.0f);
  return hn::And(hn::BitCast(du, hn::Max(x, hn::Zero(d)) + binade), hn::Set(du, 63u));
}

/// One lane's pixel that gathers.
struct Receiver {
  V px, py, pz;
  V nx, ny, nz;  ///< normal, bent to face the viewer
  V vx, vy, vz;  ///< unit, to the viewer
  V distance;    ///< to the viewer
  V plane;       ///< N.x of the points x of its tangent plane, and what rounding may add to it
  V facing, inverse_facing;  ///< N.V
  M valid;
};

HWY_INLINE Receiver load_receiver(const MarchScene& scene, std::ptrdiff_t i) {
  const D d;
  Receiver p;
  p.px = hn::LoadU(d, scene.x.data() + i);
  p.py = hn::LoadU(d, scene.y.data() + i);
  p.pz = hn::LoadU(d, scene.z.data() + i);
  p.nx = hn::LoadU(d, scene.nx.data() + i);
  p.ny = hn::LoadU(d, scene.ny.data() + i);
  p.nz = hn::LoadU(d, scene.nz.data() + i);
  p.valid = p.pz == p.pz;
  p.distance = hn::Sqrt(dot3(p.px, p.py, p.pz, p.px, p.py, p.pz));
  if (scene.orthographic) {
    p.vx = p.vy = hn::Zero(d);
    p.vz = hn::Set(d, 1.0f);
  } else {
    const V scale = hn::Set(d, -1.0f) / p.distance;
    p.vx = p.px * scale, p.vy = p.py * scale, p.vz = p.pz * scale;
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
  p.inverse_facing = hn::Set(d, 1.0f) / p.facing;
  p.plane = dot3(p.nx, p.ny, p.nz, p.px, p.py, p.pz) +
            hn::MulAdd(p.distance, hn::Set(d, kDotError), hn::LoadU(d, scene.rounding.data() + i));
  return p;
}

/// Distance in the picture beyond which nothing can be within `radius` of a receiver: seen from
/// the viewer, a ray at slope e from the receiver's passes it at d e / (l + e), l the length of
/// the receiver's ray per unit of depth.
HWY_INLINE float reach_px(const MarchScene& scene, const Receiver& p, float radius) {
  const D d;
  const float f = scene.fx > scene.fy ? scene.fx : scene.fy;
  if (scene.orthographic) return radius * f;
  const V depth = hn::Zero(d) - p.pz, r = hn::Set(d, radius);
  const V slope = r * p.distance / (depth * (depth - r));
  const V all = hn::IfThenElse(depth > r, slope, hn::Set(d, 1e30f));
  return f * hn::GetLane(hn::MaxOfLanes(d, hn::IfThenElseZero(p.valid, all)));
}

/// Half of a slice, seen from the receiver. Points of the slice have coordinates (s, v) along T
/// and V; a direction at angle theta from V has the measure n_t (theta - sin theta cos theta) +
/// n_v sin^2 theta, half of which is the integral of |sin theta| cos(theta, N) from V on.
struct Half {
  V tx, ty, tz;  ///< unit, perpendicular to V
  V origin;      ///< T.p
  V slope;       ///< n_t / n_v
  V n_t;
  V cap_scale, sine_scale;  ///< measure to sectors
  V measure;                ///< of all sectors
  V gamma;                  ///< angle of the normal from V, towards T
};

/// 1 / sqrt(x), off by 4e-4 at most.
HWY_INLINE V reciprocal_sqrt(V x) {
#if HWY_TARGET == HWY_SCALAR
  return hn::Set(D(), 1.0f) / hn::Sqrt(x);  // Highway's own is off by 2e-3 here
#else
  return hn::ApproximateReciprocalSqrt(x);
#endif
}

HWY_INLINE V sectors_of(const Half& half, V s, V v, V distance2) {
  const V inverse = reciprocal_sqrt(distance2);
  const V sine = s * inverse, cosine = v * inverse;
  return hn::MulAdd(half.cap_scale, cap_measure(sine, cosine), half.sine_scale * sine * sine);
}

/// The sectors that a surface hides which lies at (s, v) and reaches back by `depth`. It is
/// `above` the tangent plane of the receiver.
template <bool kOrthographic>
HWY_INLINE VU sectors_behind(const Receiver& p, const Half& half, V s, V above, V depth,
                             float radius, float to_first) {
  const D d;
  const DU du;
  const V zero = hn::Zero(d), first = hn::Set(d, to_first);
  // The pixel's centre lies beside the slice. Moved into it along the receiver's tangent plane, a
  // sample keeps its height above that plane: a plane stays open whatever its tilt.
  const V v = hn::MulSub(above, p.inverse_facing, s * half.slope);
  const V distance2 = dot2(s, v, s, v);
  const M meets = hn::And(above > zero, distance2 <= hn::Set(d, radius * radius));
  const VU from = nearest_whole(sectors_of(half, s, v, distance2) + first);

  const V back_s = kOrthographic ? s : hn::MulAdd(depth, s, s);
  const V back_v = kOrthographic ? v - depth : hn::MulAdd(depth, v - p.distance, v);
  const M back_above = dot2(half.n_t, p.facing, back_s, back_v) > zero;
  const V back = sectors_of(half, back_s, back_v, dot2(back_s, back_v, back_s, back_v));
  const VU to = nearest_whole(hn::IfThenElse(back_above, back, hn::Set(d, kSectors)) + first);
  return hn::IfThenElseZero(hn::RebindMask(du, meets), hn::AndNot(bits_from(to), bits_from(from)));
}

/// Marches from near to far and gives the sectors that are hidden. `seen` and `covered` hear of
/// samples of what is seen and of what it covers: their index, and the sectors in which they are
/// the first.
template <bool kOrthographic, class Seen, class Covered>
HWY_INLINE VU march_side(const March& march, const Receiver& p, const Half& half,
                         const SliceSide& side, std::ptrdiff_t at, int y, int column, float reach,
                         const Seen& seen, const Covered& covered) {
  const D d;
  const DU du;
  const MarchScene& scene = march.scene;
  const V zero = hn::Zero(d);
  // Sector i is hidden when i + phase lies in the interval.
  const float to_first = 0.5f - side.phase;
  const int height = scene.layout.height(), columns = scene.layout.columns();
  const int lanes = int(hn::Lanes(d));
  VU hidden = hn::Zero(du);
  for (const SliceStep& step : side.steps) {
    const int row = y + step.dy, first = column + step.column_shift;
    if (step.distance_px > reach || row < 0 || row >= height || first >= columns ||
        first + lanes <= 0)
      break;
    const std::ptrdiff_t i = at + step.offset;
    const auto load = [&](const InterleavedPlane& plane)
                          HWY_ATTR { return hn::LoadU(d, plane.data() + i); };
    const V qx = load(scene.x), qy = load(scene.y), qz = load(scene.z);
    const V height_q = dot3(qx, qy, qz, p.nx, p.ny, p.nz), above = height_q - p.plane;
    const V behind = load(scene.behind);
    const V above_behind = kOrthographic ? hn::NegMulAdd(behind, p.facing, above)
                                         : hn::MulAdd(behind, height_q, above);
    const M rises_behind = above_behind > zero;
    if (hn::AllFalse(d, hn::Or(above > zero, rises_behind))) continue;
    V s = dot3(qx, qy, qz, half.tx, half.ty, half.tz);
    if constexpr (kOrthographic) s = s - half.origin;
    {
      const VU bits = sectors_behind<kOrthographic>(p, half, s, above, load(scene.thickness),
                                                    march.radius, to_first);
      seen(i, hn::AndNot(hidden, bits));
      hidden = hn::Or(hidden, bits);
    }
    if (!hn::AllFalse(d, rises_behind)) {
      if constexpr (!kOrthographic) s = hn::MulAdd(behind, s, s);
      const VU bits = sectors_behind<kOrthographic>(
          p, half, s, above_behind, load(scene.behind_thickness), march.radius, to_first);
      covered(i, hn::AndNot(hidden, bits));
      hidden = hn::Or(hidden, bits);
    }
  }
  return hidden;
}

/// The frame of a slice at a receiver: T, the normal's share in it, and the weight that makes
/// slices which are uniform in the picture uniform around V.
struct SliceFrame {
  V tx, ty, tz, n_t, gamma, weight;
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
  const V length = hn::Sqrt(dot2(f.n_t, p.facing, f.n_t, p.facing));
  f.gamma = hn::CopySign(arc_cosine(hn::Min(p.facing / length, hn::Set(d, 1.0f))), f.n_t);
  return f;
}

HWY_INLINE Half half_of(const Receiver& p, const SliceFrame& f, bool forward) {
  const D d;
  const auto turn = [&](V v) HWY_ATTR { return forward ? v : hn::Zero(d) - v; };
  Half half;
  half.tx = turn(f.tx), half.ty = turn(f.ty), half.tz = turn(f.tz);
  half.n_t = turn(f.n_t);
  half.gamma = turn(f.gamma);
  half.origin = dot3(half.tx, half.ty, half.tz, p.px, p.py, p.pz);
  half.slope = half.n_t * p.inverse_facing;
  // Twice the integral up to gamma + pi/2, where the cosine ends.
  half.measure =
      hn::Max(hn::MulAdd(half.n_t, half.gamma + hn::Set(d, kPi / 2), p.facing), hn::Zero(d));
  const V to_sectors = hn::Set(d, kSectors) / hn::Max(half.measure, hn::Set(d, 1e-6f));
  half.cap_scale = half.n_t * to_sectors;
  half.sine_scale = p.facing * to_sectors;
  return half;
}

HWY_INLINE V count(VU bits) {
  return hn::ConvertTo(D(), hn::BitCast(DI(), hn::PopulationCount(bits)));
}

/// Calls `work(index, y, comb, column)` for each vector of pixels that shows a surface.
template <class Work>
HWY_INLINE void for_each_vector(const MarchScene& scene, int x0, int x1, int y0, int y1,
                                const Work& work) {
  const D d;
  const Interleaving& layout = scene.layout;
  constexpr int kPeriod = Interleaving::kPeriod;
  const int first = (x0 + layout.phase()) / kPeriod,
            last = (x1 + layout.phase() + kPeriod - 1) / kPeriod;
  for (int y = y0; y < y1; ++y) {
    for (int comb = 0; comb < kPeriod; ++comb) {
      for (int column = first; column < last; column += int(hn::Lanes(d))) {
        const std::ptrdiff_t i = layout.index(y, comb, column);
        const V z = hn::LoadU(d, scene.z.data() + i);
        if (!hn::AllFalse(d, z == z)) work(i, y, comb, column);
      }
    }
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
