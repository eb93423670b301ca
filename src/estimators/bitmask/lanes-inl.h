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

#include <cmath>

#include "estimators/bitmask/march.h"
#include "estimators/bitmask/slice_sectors.h"
#include "estimators/receiver-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Error of a height above a tangent plane, over the distance to the viewer: 4 units in the last
/// place.
constexpr float kHeightError = 2.4e-7f;

/// Error of the difference of two cosines from reciprocal_sqrt().
constexpr float kCosineError = 2 * kReciprocalSqrtError;

/// The bits from `first` (0..32 or more) on.
HWY_INLINE VU bits_from(VU first) {
#if HWY_TARGET == HWY_SCALAR
  return hn::IfThenElseZero(first < set_bits(32), set_bits(~0u) << hn::Min(first, set_bits(31)));
#else
  return set_bits(~0u) << first;  // nothing is left of a shift by 32 or more
#endif
}

/// Columns of the picture that the lanes stand for.
HWY_INLINE V lane_columns(const Interleaving& layout, int column_phase, int column) {
  constexpr int kPeriod = Interleaving::kPeriod;
  return hn::ConvertTo(D(), hn::Iota(DI(), 0) * set_int(kPeriod) +
                                set_int(column * kPeriod + column_phase - layout.phase()));
}

/// Values side by side in the order of the march, from index `i` on.
HWY_INLINE V load(const InterleavedPlane& plane, std::ptrdiff_t i) {
  return load(plane.data() + i);
}
HWY_INLINE V3 load(const InterleavedVectors& color, std::ptrdiff_t i) {
  return {load(color[0], i), load(color[1], i), load(color[2], i)};
}
HWY_INLINE void store(V value, InterleavedPlane& plane, std::ptrdiff_t i) {
  store(value, plane.data() + i);
}
HWY_INLINE void store(const V3& value, InterleavedVectors& color, std::ptrdiff_t i) {
  store(value.x, color[0], i), store(value.y, color[1], i), store(value.z, color[2], i);
}

/// Where in the raster a vector of pixels is: every eighth one of row `y` from `column_phase` on,
/// of which it holds those from `column` on.
struct Place {
  std::ptrdiff_t index;
  int y, column_phase, column;
};

/// Receivers among the pixels of MarchScene. Their normals are bent to face the viewer.
struct MarchReceiver : Receiver {
  Place place;         ///< of all lanes
  float reach_px = 0;  ///< of all lanes: no pixel farther away can be within the radius
  V slope_x, slope_y;  ///< of the ray through it, or its place where the camera is orthographic
  V3 to_viewer;        ///< unit: V
  V distance;          ///< to the viewer
  V facing;            ///< N.V
  /// Height of what a pixel shows above the tangent plane, along V and less what rounding may have
  /// added: depth (rise + rise_x dx + rise_y dy) + plane, for a pixel that lies (dx, dy) from this.
  V rise, rise_x, rise_y, plane;
};

HWY_INLINE MarchReceiver load_receiver(const MarchScene& scene, const Place& place) {
  const auto [i, y, column_phase, column] = place;
  MarchReceiver p;
  p.place = place;
  hwy::Prefetch(scene.rounding.data() + i + 4 * kLanes);  // nothing else comes by here
  const V depth = load(scene.depth(), i);
  p.x = lane_columns(scene.layout, column_phase, column), p.y = set(float(y));
  p.normal = load(scene.normal, i);
  p.valid = depth == depth;
  const V one = set(1), zero = set(0);
  p.slope_x = (p.x + set(float(scene.first_x)) - set(scene.axis_x)) * set(1 / scene.fx);
  p.slope_y = (set(scene.axis_y) - set(float(y + scene.first_y))) * set(1 / scene.fy);
  if (scene.orthographic) {
    p.position = {p.slope_x, p.slope_y, zero - depth};
    p.to_viewer = {zero, zero, one};
    p.rise = zero;
    p.distance = depth;
  } else {
    p.position = {p.slope_x * depth, p.slope_y * depth, zero - depth};
    const V length =
        hn::Sqrt(hn::MulAdd(p.slope_x, p.slope_x, hn::MulAdd(p.slope_y, p.slope_y, one)));
    const V towards = one / length;
    p.to_viewer = {zero - p.slope_x * towards, zero - p.slope_y * towards, towards};
    p.rise = zero - length;  // N.V / facing is 1
    p.distance = depth * length;
  }
  p.facing = dot(p.normal, p.to_viewer);
  const V least = set(kLeastFacing);
  const M away = p.facing < least;
  if (any(away)) {
    const V lift = hn::IfThenElseZero(away, least - p.facing);
    p.normal = mul_add(p.to_viewer, lift, p.normal);
    p.facing = hn::Max(p.facing, least);
  }
  const V along_view = one / p.facing;
  p.rise_x = p.normal.x * along_view * set(1 / scene.fx);
  p.rise_y = p.normal.y * along_view * set(-1 / scene.fy);
  const V margin = hn::MulAdd(p.distance, set(kHeightError), load(scene.rounding, i));
  p.plane = hn::NegMulAdd(margin, along_view, p.distance);
  return p;
}

/// Normals as the frame has them; lanes without a surface look at the viewer.
HWY_INLINE V3 load_normals(const MarchScene& scene, std::ptrdiff_t i, M valid) {
  return if_then_else(valid, load(scene.normal, i), set(glm::vec3(0, 0, 1)));
}

/// Height of the surface at `depth`, (dx, dy) pixels from the receiver.
template <bool kOrthographic>
HWY_INLINE V height_above(const MarchReceiver& p, V rise, V depth) {
  if constexpr (kOrthographic) return rise + (p.plane - depth);
  return hn::MulAdd(depth, rise, p.plane);
}

/// Distance in the picture beyond which nothing can be within `radius` of a receiver: seen from
/// the viewer, a ray at slope e from the receiver's passes it at d e / (l + e), l the length of
/// the receiver's ray per unit of depth.
HWY_INLINE float reach_px(const MarchScene& scene, const MarchReceiver& p, float radius) {
  const float f = scene.fx > scene.fy ? scene.fx : scene.fy;
  if (scene.orthographic || radius > 1e18f) return radius * f;
  const V depth = set(0) - p.position.z, r = set(radius);
  const V slope = r * p.distance / (depth * (depth - r));
  const V reach = hn::IfThenElse(depth > r, slope, set(1e30f));
  return f * hn::GetLane(hn::MaxOfLanes(D(), hn::IfThenElseZero(p.valid, reach)));
}

/// The number of the first sector whose point lies behind a direction with the cosine c to V. The
/// point of sector i is at i + phase; `start` is start_of_sectors(phase).
HWY_INLINE VU sector_at(V c, V start) {
  // Around 1.5 * 2^23 a float's unit is one, and its low bits are the whole number nearest to it.
  const V x = hn::NegMulAdd(c, set(SliceSectors::kPerCosine), start);
  return hn::And(hn::BitCast(DU(), x + set(12582912)), set_bits(63));
}

HWY_INLINE V start_of_sectors(float phase) { return set(SliceSectors::kPerCosine + 0.5f - phase); }

HWY_INLINE VU sector_of(V v, V distance2, V start) {
  return sector_at(v * reciprocal_sqrt(distance2), start);
}

/// A point in a slice, along T and V.
struct SlicePoint {
  V s, v;
};

HWY_INLINE V dot(const SlicePoint& a, const SlicePoint& b) {
  return hn::MulAdd(a.s, b.s, a.v * b.v);
}

/// The point a share of a way from another one.
HWY_INLINE SlicePoint along(const SlicePoint& from, V share, const SlicePoint& way) {
  return {hn::MulAdd(share, way.s, from.s), hn::MulAdd(share, way.v, from.v)};
}

/// The sector in which a point lies, as sector_at() has it.
HWY_INLINE VU sector_of(const SlicePoint& p, V start) { return sector_of(p.v, dot(p, p), start); }

/// Where the back is of what has its front there: behind it on its own view ray.
template <bool kOrthographic>
HWY_INLINE SlicePoint back_of(const MarchReceiver& p, const SlicePoint& front, V depth) {
  const auto [s, v] = front;
  if constexpr (kOrthographic) return {s, v - depth};
  return {hn::MulAdd(depth, s, s), hn::MulAdd(depth, v - p.distance, v)};
}

/// One side of a slice, seen from the receiver. Its points have coordinates (s, v) along T and V.
struct SideFrame {
  V3 t;       ///< unit, perpendicular to V
  V2 across;  ///< s of a point of a ray is its depth times across . (dx, dy)
  V slope;    ///< n_t / n_v
  V n_t;
  V start;         ///< start_of_sectors() of the side's phase
  VU above;        ///< the sectors above the tangent plane, whose number is
  VU above_count;  ///< 0..31: the last sector leads away from the viewer
};

/// The sectors that a surface hides which lies at s, `above` the receiver's tangent plane, and
/// reaches back by `depth`.
template <bool kOrthographic>
HWY_INLINE VU sectors_behind(const MarchReceiver& p, const SideFrame& side, V s, V above, V depth,
                             float radius) {
  // Centres of sampled pixels are not exactly in the plane of the slice. They are projected into it
  // parallel to the receiver's tangent plane, which keeps their heights: a plane never occludes
  // itself, whatever its tilt.
  const SlicePoint front{s, hn::NegMulAdd(s, side.slope, above)};
  const V distance2 = dot(front, front);
  const M meets = hn::And(above > set(0), distance2 <= set(radius * radius));
  const VU from = sector_of(front.v, distance2, side.start),
           to = sector_of(back_of<kOrthographic>(p, front, depth), side.start);
  return hn::IfThenElseZero(hn::RebindMask(DU(), meets),
                            hn::AndNot(bits_from(to), bits_from(from)));
}

/// The frame of a slice at a receiver: T, the normal's share in it, and the weight that makes
/// slices which are uniform in the picture uniform around V.
struct SliceFrame {
  V3 t;
  V n_t, weight;
};

HWY_INLINE SliceFrame slice_frame(const MarchScene& scene, const MarchReceiver& p,
                                  const Slice& slice) {
  const V ex = set(slice.dx / scene.fx), ey = set(-slice.dy / scene.fy);
  const V along = dot(V2{ex, ey}, V2{p.to_viewer.x, p.to_viewer.y});
  const V3 t{hn::NegMulAdd(along, p.to_viewer.x, ex), hn::NegMulAdd(along, p.to_viewer.y, ey),
             set(0) - along * p.to_viewer.z};
  SliceFrame f;
  f.weight = set(1) / dot(t, t);
  f.t = t * hn::Sqrt(f.weight);
  // The weight has the unit of f^2; only ratios matter.
  f.n_t = dot(p.normal, f.t);
  return f;
}

/// The side along the slice's direction, where `forward`, or against it.
HWY_INLINE SideFrame side_frame(const MarchScene& scene, const MarchReceiver& p,
                                const SliceFrame& f, bool forward, float phase) {
  SideFrame side;
  side.t = forward ? f.t : set(glm::vec3(0)) - f.t;
  side.n_t = forward ? f.n_t : set(0) - f.n_t;
  side.across = {side.t.x * set(1 / scene.fx), side.t.y * set(-1 / scene.fy)};
  side.slope = side.n_t / p.facing;
  // In the slice the tangent plane leads away from V by pi/2 more than the normal does. Points
  // that rounding could lift above it do not count, nor does a sector that lies more below it than
  // above: its integral is negative.
  const V cosine =
      hn::NegMulAdd(side.n_t, reciprocal_sqrt(dot(V2{side.n_t, p.facing}, V2{side.n_t, p.facing})),
                    set(kCosineError));
  const V last_above = start_of_sectors(phase > 0.5f ? phase : 0.5f);
  side.above_count = hn::Min(sector_at(cosine, last_above), set_bits(31));
  side.start = start_of_sectors(phase);
  side.above = hn::Not(bits_from(side.above_count));
  return side;
}

/// Calls `work(place)` for each vector of pixels of a part of the raster that shows a surface;
/// pixels beside the part may be among its lanes.
template <class Work>
HWY_INLINE void for_each_vector(const MarchScene& scene, const Window& part, const Work& work) {
  const Interleaving& layout = scene.layout;
  const int begin = ((part.x0 + layout.phase()) >> Interleaving::kShift) & -kLanes,
            end = ((part.x1 - 1 + layout.phase()) >> Interleaving::kShift) + 1;
  for (int y = part.y0; y < part.y1; ++y) {
    for (int column_phase = 0; column_phase < Interleaving::kPeriod; ++column_phase) {
      for (int column = begin; column < end; column += kLanes) {
        const std::ptrdiff_t i = layout.index(y, column_phase, column);
        const V depth = load(scene.depth(), i);
        if (any(depth == depth)) work(Place{i, y, column_phase, column});
      }
    }
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
