// SPDX-License-Identifier: Apache-2.0
//
// The piece of surface that each sampled pixel of a march represents; see bitmask.cpp.
//
// Steps grow with distance, so a march samples few pixels of distant geometry. Treated as points,
// samples miss up to half a step at the upper edge of an occluder, and any occluder thinner than a
// step: over seven frames ao was 0.023 too open at 24 steps. So each sampled pixel represents the
// stretch of the march from halfway to the sample before to halfway to the one after, and its
// surface is extended over that stretch along its tangent plane. This is exact on a plane. At edges
// and on thin occluders it is right on average, because steps fall elsewhere in every pixel of the
// pattern.
#if defined(SSDO_BITMASK_PIECE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_PIECE_INL_H_
#undef SSDO_BITMASK_PIECE_INL_H_
#else
#define SSDO_BITMASK_PIECE_INL_H_
#endif

#include <algorithm>

#include "estimators/bitmask/solid_sectors-inl.h"
#include "scene/same_surface.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// A straight piece of surface in a slice.
struct Piece {
  SlicePoint inner, outer;
};

/// The end of a piece, at `share` of the way from the receiver to the sampled pixel and at this
/// depth. `rise` and `across` are those of the pixel.
template <bool kOrthographic>
HWY_INLINE SlicePoint end_at(const MarchReceiver& p, const SideFrame& side, V share, V depth,
                             V rise, V across) {
  V s = across * share;
  if constexpr (!kOrthographic) s = s * depth;
  const V end_rise = hn::MulAdd(share, rise - p.rise, p.rise);
  return {s, hn::NegMulAdd(s, side.slope, height_above<kOrthographic>(p, end_rise, depth))};
}

/// Largest factor by which depth may grow or shrink from a pixel to the ends of its piece: where a
/// plane is seen edge-on, or reaches its horizon within the step, the piece is cut there. Some
/// limit is needed, but its value does not matter: on four scenes of Cycles 1.4 and 4 change the
/// mean errors of ao and direct light by less than 0.001.
constexpr float kMostDeepening = 2;

/// The piece that the pixel at `i` represents. `rise` and `across` are those of its middle.
template <bool kOrthographic>
HWY_INLINE Piece piece_at(const MarchPlanes& planes, const MarchReceiver& p, const SideFrame& side,
                          const SliceStep& step, std::ptrdiff_t i, V depth, V rise, V across) {
  const V one = set(1), nearer = nearer_over(planes, i, step);
  const auto end = [&](float of_way, bool inner) HWY_ATTR {
    V share = set(of_way);
    const V change = nearer * (share - one);
    // A depth may be 0 or negative where the camera is orthographic, so that no factor can limit
    // it: it changes by at most the distance across.
    const V most = kOrthographic ? hn::Abs(across) : set(kMostDeepening - 1),
            least = kOrthographic ? hn::Neg(most) : set(1 / kMostDeepening - 1);
    const V limited = hn::Clamp(change, least, most);
    const M beyond = limited != change;
    if (any(beyond)) share = hn::IfThenElse(beyond, one + limited / nearer, share);
    V end_depth = kOrthographic ? depth - limited : depth / (one + limited);
    // On a round silhouette the tangent plane would extend far in front of the surface.
    if (inner) end_depth = hn::Max(end_depth, depth);
    return end_at<kOrthographic>(p, side, share, end_depth, rise, across);
  };
  return {end(step.inner, true), end(step.outer, false)};
}

/// The piece of a front at this depth whose slope is unknown: taken to face the viewer.
template <bool kOrthographic>
HWY_INLINE Piece piece_facing_viewer(const MarchReceiver& p, const SideFrame& side,
                                     const SliceStep& step, V depth, V rise, V across) {
  return {end_at<kOrthographic>(p, side, set(step.inner), depth, rise, across),
          end_at<kOrthographic>(p, side, set(step.outer), depth, rise, across)};
}

/// Cuts the piece to the part within the radius, and returns the lanes where there is such a part.
HWY_INLINE M clip(Piece& piece, float radius) {
  const V zero = set(0), one = set(1);
  const SlicePoint start = piece.inner, way{piece.outer.s - start.s, piece.outer.v - start.v};
  const V per_length = one / hn::Sqrt(hn::Max(dot(way, way), set(1e-30f)));
  const SlicePoint unit{way.s * per_length, way.v * per_length};
  // The line through the piece is `nearest` away from the receiver at its `foot`, and within the
  // radius for half a chord on both sides of it.
  const V nearest = hn::MulSub(start.s, unit.v, start.v * unit.s), foot = zero - dot(start, unit),
          half_chord2 = hn::NegMulAdd(nearest, nearest, set(radius * radius));
  const V half_chord = hn::Sqrt(hn::Max(half_chord2, zero));
  const V from = hn::Max(zero, (foot - half_chord) * per_length),
          to = hn::Min(one, (foot + half_chord) * per_length);
  piece.inner = along(start, from, way), piece.outer = along(start, to, way);
  return hn::And(half_chord2 > zero, from < to);
}

/// The sectors hidden by a solid whose front is the piece. Its middle is at s and at the height
/// `above` over the receiver's tangent plane; its back is `depth` behind that.
template <bool kOrthographic>
HWY_INLINE VU sectors_behind_piece(const MarchReceiver& p, const SideFrame& side, Piece piece, V s,
                                   V above, V depth, float radius) {
  const SlicePoint middle{s, hn::NegMulAdd(s, side.slope, above)};
  const WithinRadius solid = view_ray_within<kOrthographic>(p, side, middle, depth, radius);
  const M shown = radius < kInfiniteLength ? clip(piece, radius) : solid.exists;
  const VU inner = sector_of(piece.inner, side.start), outer = sector_of(piece.outer, side.start);
  VU from = hn::Min(inner, outer), to = hn::Max(hn::Max(inner, outer), solid.to);
  if (radius < kInfiniteLength) {
    // Either may be outside: the piece, or the view ray behind its middle.
    const auto behind = hn::RebindMask(DU(), solid.exists), front = hn::RebindMask(DU(), shown);
    from =
        hn::IfThenElse(behind, hn::IfThenElse(front, hn::Min(from, solid.from), solid.from), from);
    to = hn::IfThenElse(behind, hn::IfThenElse(front, to, solid.to), hn::Max(inner, outer));
  }
  const M meets = hn::And(above > set(0), hn::Or(shown, solid.exists));
  return hn::IfThenElseZero(hn::RebindMask(DU(), meets),
                            hn::AndNot(bits_from(to), bits_from(from)));
}

/// The front that a march met at a step, and its pixel; no step: none so far.
struct Front {
  const SliceStep* step;
  std::ptrdiff_t pixel;
  V depth;
};

/// The sectors between two fronts that a march meets one after the other, where they are on one
/// surface (scene/same_surface.h): it is closed between them. Solids hide those sectors by
/// themselves only if they are thicker than the fronts are apart. `is_above`: the later one is
/// above the receiver's tangent plane.
template <bool kOrthographic>
HWY_INLINE VU sectors_between(const March& march, const MarchPlanes& planes, const MarchReceiver& p,
                              const SideFrame& side, const Front& before, const Front& here,
                              M is_above) {
  const MarchScene& scene = march.scene;
  const auto point = [&](const Front& f) HWY_ATTR {
    const V dx = set(f.step->dx), dy = set(f.step->dy), across = dot(V2{dx, dy}, side.across),
            s = kOrthographic ? across : f.depth * across,
            rise = hn::MulAdd(dx, p.rise_x, hn::MulAdd(dy, p.rise_y, p.rise));
    return SlicePoint{s,
                      hn::NegMulAdd(s, side.slope, height_above<kOrthographic>(p, rise, f.depth))};
  };
  const auto position = [&](const Front& f) HWY_ATTR {
    const V x = p.slope_x + set(f.step->dx / scene.fx), y = p.slope_y - set(f.step->dy / scene.fy),
            z = set(0) - f.depth;
    if constexpr (kOrthographic) return V3{x, y, z};
    return V3{x * f.depth, y * f.depth, z};
  };
  const V3 way = position(before) - position(here);
  const auto from_plane_of = [&](const Front& f) HWY_ATTR {
    const V2 slope{p.slope_x + set(f.step->dx / scene.fx), p.slope_y - set(f.step->dy / scene.fy)};
    return hn::Abs(dot(load_normal(scene, planes.tilt, planes.tilt_rest, f.pixel, slope), way));
  };
  const V gap = hn::Max(from_plane_of(here), from_plane_of(before));
  V most = set(kSurfaceGap / std::min(scene.fx, scene.fy));
  if constexpr (!kOrthographic) most = most * hn::Min(before.depth, here.depth);
  const SlicePoint end = point(here);
  const M meets =
      hn::And(hn::And(is_above, gap <= most), dot(end, end) <= set(march.radius * march.radius));
  const VU a = sector_of(point(before), side.start), b = sector_of(end, side.start);
  return hn::IfThenElseZero(hn::RebindMask(DU(), meets),
                            hn::AndNot(bits_from(hn::Max(a, b)), bits_from(hn::Min(a, b))));
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
