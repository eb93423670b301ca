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

#include <array>
#include <cmath>

#include "estimators/bitmask/jobs.h"
#include "estimators/bitmask/slice_sectors.h"
#include "estimators/receiver-inl.h"
#include "math/infinity.h"
#include "scene/same_surface-inl.h"
#include "simd/bf16x2-inl.h"
#include "simd/fixed_ratio16-inl.h"
#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The rounding error of a height above a tangent plane, as a share of the distance to the viewer:
/// 4 units in the last place.
constexpr float kHeightError = 2.4e-7f;

/// Least difference of two cosines that is more than rounding.
constexpr float kCosineError = 8e-4f;

/// The bits from `first` (0..32 or more) on.
HWY_INLINE VU bits_from(VU first) {
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
  return set_bits(~0u) << first;  // nothing is left of a shift by 32 or more
#else
  return hn::IfThenElseZero(first < set_bits(32), set_bits(~0u) << hn::Min(first, set_bits(31)));
#endif
}

/// Columns of the picture that the lanes stand for.
HWY_INLINE V lane_columns(const Interleaving& layout, int column_phase, int column) {
  constexpr int kPeriod = Interleaving::kPeriod;
  return hn::ConvertTo(D(), hn::Iota(DI(), 0) * set_int(kPeriod) +
                                set_int(column * kPeriod + column_phase - layout.phase()));
}

/// Consecutive values in the order of the march, from index `i` on.
template <class T>
HWY_INLINE V load(const InterleavedValues<T>& plane, std::ptrdiff_t i) {
  return load(plane.data() + i);
}
template <class T>
HWY_INLINE V3 load(const std::array<InterleavedValues<T>, 3>& color, std::ptrdiff_t i) {
  return {load(color[0], i), load(color[1], i), load(color[2], i)};
}
template <class T>
HWY_INLINE void store(V value, InterleavedValues<T>& plane, std::ptrdiff_t i) {
  store(value, plane.data() + i);
}
template <class T>
HWY_INLINE void store(const V3& value, std::array<InterleavedValues<T>, 3>& color,
                      std::ptrdiff_t i) {
  store(value.x, color[0], i), store(value.y, color[1], i), store(value.z, color[2], i);
}

/// Both sides of a surface, from what they send.
HWY_INLINE V3 front_of(const V3& sides) {
  return {unpack_bf16_first(sides.x), unpack_bf16_first(sides.y), unpack_bf16_first(sides.z)};
}
HWY_INLINE V3 back_of(const V3& sides) {
  return {unpack_bf16_second(sides.x), unpack_bf16_second(sides.y), unpack_bf16_second(sides.z)};
}

/// holds_solid() of march_scene.h for a vector of depths: false where the depth is NaN.
HWY_INLINE M holds_solid(V depth) { return depth == depth; }

/// The place of a vector of pixels in the raster. Lane k is the pixel of row `y` and of column 8
/// (column + k) + column_phase - Interleaving::phase().
struct Place {
  std::ptrdiff_t index;
  int y, column_phase, column;
};

/// The pixels (dx, dy) away, no more than kPeriod.
HWY_INLINE Place place_beside(const Interleaving& layout, const Place& place, int dx, int dy) {
  const int y = place.y + dy, shifted = place.column_phase + dx,
            column_phase = shifted & (Interleaving::kPeriod - 1),
            column = place.column + (shifted >> Interleaving::kShift);
  return {layout.index(y, column_phase, column), y, column_phase, column};
}

/// The columns of a vector of pixels; lanes beside the raster get its first or last column.
HWY_INLINE VI columns_of(const MarchScene& scene, const Place& place) {
  const VI columns =
      hn::ConvertTo(DI(), lane_columns(scene.layout, place.column_phase, place.column));
  return hn::Clamp(columns, set_int(0), set_int(scene.layout.width() - 1));
}

/// The values of the surfels of a vector of pixels other than the position; lanes beside the raster
/// get those of its first or last column.
struct Shading {
  V3 normal;
  V rounding;
};

HWY_INLINE Shading load_shading(const MarchScene& scene, const Place& place) {
  const auto& [x, y, z] = scene.surfaces.normal;
  const VI at = columns_of(scene, place);
  return {{gather(&x(0, place.y), at), gather(&y(0, place.y), at), gather(&z(0, place.y), at)},
          gather(&scene.surfaces.rounding(0, place.y), at)};
}

/// Receivers among the pixels of MarchScene. Their normals are bent to face the viewer. The march
/// is bounded by the surface itself, with `normal`; what it finds is weighed by the cosine to
/// `shading`.
struct MarchReceiver : Receiver {
  Place place;         ///< of all lanes
  float reach_px = 0;  ///< of all lanes: no pixel farther away in the picture is within the radius
  V own_reach_px;      ///< the same by lane, of the receivers of marches
  V slope_x, slope_y;  ///< of the pixel's ray, or its x and y where the camera is orthographic
  V3 to_viewer;        ///< unit: V
  V distance;          ///< to the viewer
  V facing;            ///< N.V
  V3 shading;          ///< unit
  V shading_v;         ///< its cosine to V
  /// The height of the surface in the pixel (dx, dy) away over the tangent plane, along V, is depth
  /// (rise + rise_x dx + rise_y dy) + plane; for orthographic cameras see height_above(). A margin
  /// for rounding is subtracted in `plane`.
  V rise, rise_x, rise_y, plane;
};

/// The normals, not of unit length, of tangent planes with this `tilt` (as in MarchPlanes), in
/// pixels whose rays have this slope.
HWY_INLINE V3 normal_of_tilt(const MarchScene& scene, const V2& tilt, const V2& slope) {
  const V2 aside{tilt.x * set(-scene.fx), tilt.y * set(scene.fy)};
  const V one = set(1);
  return {aside.x, aside.y, scene.orthographic ? one : one + dot(aside, slope)};
}

/// The unit normals of tangent planes at index `q` of a tilt and its rest, as MarchPlanes has them.
HWY_INLINE V3 load_normal(const MarchScene& scene, const InterleavedPlane& tilts,
                          const InterleavedPlane& rests, std::ptrdiff_t q, const V2& slope) {
  const V2 tilt = unpack_bf16x2_exact(load(tilts, q), load(rests, q));
  const V3 normal = normal_of_tilt(scene, tilt, slope);
  return normal * (set(1) / hn::Sqrt(dot(normal, normal)));
}

/// Bends unit normals to face the viewer, and returns their cosines to V.
HWY_INLINE V bend_to_viewer(V3& normal, const V3& to_viewer) {
  const V least = set(kLeastFacing), facing = dot(normal, to_viewer);
  const M away = facing < least;
  if (!any(away)) return facing;
  normal = mul_add(to_viewer, hn::IfThenElseZero(away, least - facing), normal);
  return hn::Max(facing, least);
}

HWY_INLINE MarchReceiver load_receiver(const MarchScene& scene, const Place& place) {
  const auto [i, y, column_phase, column] = place;
  MarchReceiver p;
  p.place = place, p.own_reach_px = set(0);
  const V depth = load(scene.receiver_depth(), i);
  p.x = lane_columns(scene.layout, column_phase, column), p.y = set(float(y));
  p.valid = holds_solid(depth);
  const V one = set(1), zero = set(0);
  p.slope_x = (p.x + set(float(scene.first_x)) - set(scene.axis_x)) * set(1 / scene.fx);
  p.slope_y = (set(scene.axis_y) - set(float(y + scene.first_y))) * set(1 / scene.fy);
  p.normal = load_normal(scene, scene.receiver_tilt(), scene.receiver_tilt_rest(), i,
                         {p.slope_x, p.slope_y});
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
  p.facing = bend_to_viewer(p.normal, p.to_viewer);
  const Shading shading = load_shading(scene, place);
  p.shading = shading.normal;
  p.shading_v = bend_to_viewer(p.shading, p.to_viewer);
  const V along_view = one / p.facing;
  p.rise_x = p.normal.x * along_view * set(1 / scene.fx);
  p.rise_y = p.normal.y * along_view * set(-1 / scene.fy);
  const V margin = hn::MulAdd(p.distance, set(kHeightError), shading.rounding);
  p.plane = hn::NegMulAdd(margin, along_view, p.distance);
  return p;
}

/// Normals of a vector of pixels; (0, 0, 1) in lanes without a surface.
HWY_INLINE V3 usable(const V3& normals, M valid) {
  return if_then_else(valid, normals, set(glm::vec3(0, 0, 1)));
}

/// The change of nearness along the tangent planes of the pixels at index `q` over a step to them,
/// in the units of MarchPlanes::tilt.
HWY_INLINE V nearer_over(const MarchPlanes& planes, std::ptrdiff_t q, const SliceStep& step) {
  const V tilt = load(planes.tilt, q);
  return dot(V2{unpack_bf16_first(tilt), unpack_bf16_second(tilt)}, V2{set(step.dx), set(step.dy)});
}

/// Height above the receiver's tangent plane, along V, of a surface at `depth`. `rise` is that of
/// MarchReceiver at the surface's pixel: rise + rise_x dx + rise_y dy.
template <bool kOrthographic>
HWY_INLINE V height_above(const MarchReceiver& p, V rise, V depth) {
  if constexpr (kOrthographic) return rise + (p.plane - depth);
  return hn::MulAdd(depth, rise, p.plane);
}

/// The weight, 0..1, of a neighbour (dx, dy) pixels away as part of the receiver's surface: that of
/// scene/same_surface.h, except that the test against the plane gives 0 or 1.
template <bool kOrthographic>
HWY_INLINE V likeness(const MarchScene& scene, const MarchReceiver& p, std::ptrdiff_t q, int dx,
                      int dy) {
  const V depth = load(scene.receiver_depth(), q);
  const M valid = hn::And(p.valid, holds_solid(depth));
  const V2 slope{p.slope_x + set(float(dx) / scene.fx), p.slope_y - set(float(dy) / scene.fy)};
  V x = slope.x, y = slope.y;
  if constexpr (!kOrthographic) x = x * depth, y = y * depth;
  const V3 to_q = V3{x, y, set(0) - depth} - p.position;
  const M near = within_sine(dot(to_q, p.normal), dot(to_q, to_q), kPlaneSine);
  const V both = load(scene.receiver_tilt(), q);
  const V3 normal =
      normal_of_tilt(scene, {unpack_bf16_first(both), unpack_bf16_second(both)}, slope);
  const V cosine = dot(p.normal, normal) * reciprocal_sqrt(dot(normal, normal));
  return hn::IfThenElseZero(hn::And(valid, near), normal_weight(cosine));
}

/// The distance in the picture beyond which no point can be within `radius` of a receiver. A view
/// ray whose slope differs by e from that of the receiver's ray passes the receiver at a distance
/// of d e / (l + e), with d the receiver's distance and l the length of its ray per unit of depth.
HWY_INLINE V own_reach_px(const MarchScene& scene, const MarchReceiver& p, float radius) {
  const float f = scene.fx > scene.fy ? scene.fx : scene.fy;
  if (scene.orthographic || radius > kInfiniteLength) return set(radius * f);
  const V depth = set(0) - p.position.z, r = set(radius);
  const V slope = r * p.distance / (depth * (depth - r));
  return set(f) * hn::IfThenElse(depth > r, slope, set(1e30f));
}

/// The same of all lanes.
HWY_INLINE float reach_px(const MarchScene& scene, const MarchReceiver& p, float radius) {
  const float f = scene.fx > scene.fy ? scene.fx : scene.fy;
  if (scene.orthographic || radius > kInfiniteLength) return radius * f;
  const V reach = own_reach_px(scene, p, radius);
  return hn::GetLane(hn::MaxOfLanes(D(), hn::IfThenElseZero(p.valid, reach)));
}

/// The first sector whose sample point is at a larger angle from V than the direction with cosine
/// c. The sample point of sector i is at i + phase; `start` is start_of_sectors(phase).
HWY_INLINE VU sector_at(V c, V start) {
  // Floats near 1.5 * 2^23 are spaced by one: adding it rounds to the nearest whole number, which
  // is then in the low bits.
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

/// The point at `share` of `way` from `from`.
HWY_INLINE SlicePoint along(const SlicePoint& from, V share, const SlicePoint& way) {
  return {hn::MulAdd(share, way.s, from.s), hn::MulAdd(share, way.v, from.v)};
}

/// sector_at() for the direction to a point.
HWY_INLINE VU sector_of(const SlicePoint& p, V start) { return sector_of(p.v, dot(p, p), start); }

/// The back of a solid with this front: `depth` behind it on its own view ray.
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
  V shading_t;     ///< T . shading
  V start;         ///< start_of_sectors() of the side's phase
  VU above;        ///< the sectors above the plane across the shading normal
  VU above_count;  ///< their number, 0..31; the last sector points away from the viewer
  VU open;         ///< the sectors in `above` that the surface itself does not hide
};

/// The frame of a slice at a receiver: T, the components of both normals along it, and the weight w
/// of bitmask.cpp, which makes slices that are uniform in the picture uniform around V.
struct SliceFrame {
  V3 t;
  V n_t, shading_t, weight;
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
  // The weight has the unit of f^2, which cancels in the ratios that are taken.
  f.n_t = dot(p.normal, f.t);
  f.shading_t = dot(p.shading, f.t);
  return f;
}

/// The number of sectors above the plane across a normal with these components along V and T. In
/// the slice, the angle from V to this plane is the angle to the normal plus pi/2. Directions that
/// rounding could lift above the plane are left out, and so is a sector of which more than half
/// lies below it: its integral is negative.
HWY_INLINE VU count_above(V n_v, V n_t, float phase) {
  const V2 normal{n_t, n_v};
  const V cosine = hn::NegMulAdd(n_t, reciprocal_sqrt(dot(normal, normal)), set(kCosineError));
  const V last_above = start_of_sectors(phase > 0.5f ? phase : 0.5f);
  return hn::Min(sector_at(cosine, last_above), set_bits(31));
}

/// The side along the slice's direction if `forward`, otherwise the side against it.
HWY_INLINE SideFrame side_frame(const MarchScene& scene, const MarchReceiver& p,
                                const SliceFrame& f, bool forward, float phase) {
  SideFrame side;
  side.t = forward ? f.t : set(glm::vec3(0)) - f.t;
  side.n_t = forward ? f.n_t : set(0) - f.n_t;
  side.shading_t = forward ? f.shading_t : set(0) - f.shading_t;
  side.across = {side.t.x * set(1 / scene.fx), side.t.y * set(-1 / scene.fy)};
  side.slope = side.n_t / p.facing;
  side.start = start_of_sectors(phase);
  side.above_count = count_above(p.shading_v, side.shading_t, phase);
  side.above = hn::Not(bits_from(side.above_count));
  side.open = hn::And(side.above, hn::Not(bits_from(count_above(p.facing, side.n_t, phase))));
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
        if (any(holds_solid(load(scene.receiver_depth(), i))))
          work(Place{i, y, column_phase, column});
      }
    }
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
