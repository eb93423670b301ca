// SPDX-License-Identifier: Apache-2.0
//
// The sectors that a solid hides, by its front and its back on the view ray of a pixel; compiled
// once for every instruction set.
#if defined(SSDO_BITMASK_SOLID_SECTORS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_BITMASK_SOLID_SECTORS_INL_H_
#undef SSDO_BITMASK_SOLID_SECTORS_INL_H_
#else
#define SSDO_BITMASK_SOLID_SECTORS_INL_H_
#endif

#include "estimators/bitmask/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The part of a view ray, from the front of a solid to its back, that lies within the radius.
struct WithinRadius {
  VU from, to;  ///< sectors; a view ray leads away from V
  M exists;
};

/// The front may lie outside of the radius and the back within it, as under a ball, or the other
/// way round, as behind the top of a wall.
template <bool kOrthographic>
HWY_INLINE WithinRadius view_ray_within(const MarchReceiver& p, const SideFrame& side,
                                        const SlicePoint& front, V depth, float radius) {
  const V zero = set(0);
  if (radius > kInfiniteLength) {
    return {sector_of(front, side.start),
            sector_of(back_of<kOrthographic>(p, front, depth), side.start), zero == zero};
  }
  // The ray passes the receiver at its foot, and is within the radius for half a chord to both
  // sides of it; in units of `way`, as depth is.
  const SlicePoint way =
      kOrthographic ? SlicePoint{zero, set(-1)} : SlicePoint{front.s, front.v - p.distance};
  const V length2 = dot(way, way), foot = zero - dot(front, way),
          half_chord2 =
              hn::MulAdd(foot, foot, length2 * (set(radius * radius) - dot(front, front)));
  const V half_chord = hn::Sqrt(hn::Max(half_chord2, zero)), per_length2 = set(1) / length2;
  const V enters = hn::Max(zero, (foot - half_chord) * per_length2),
          leaves = hn::Min(depth, (foot + half_chord) * per_length2);
  return {sector_of(along(front, enters, way), side.start),
          sector_of(along(front, leaves, way), side.start),
          hn::And(half_chord2 >= zero, enters <= leaves)};
}

/// The sectors hidden by a solid whose front is at s and at the height `above` over the receiver's
/// tangent plane, and whose back is `depth` behind that.
template <bool kOrthographic>
HWY_INLINE VU sectors_behind(const MarchReceiver& p, const SideFrame& side, V s, V above, V depth,
                             float radius) {
  // Centres of sampled pixels do not lie exactly in the slice. They are projected into it parallel
  // to the receiver's tangent plane, which keeps their heights, so that no plane occludes itself at
  // any tilt.
  const SlicePoint front{s, hn::NegMulAdd(s, side.slope, above)};
  const WithinRadius solid = view_ray_within<kOrthographic>(p, side, front, depth, radius);
  return hn::IfThenElseZero(hn::RebindMask(DU(), hn::And(above > set(0), solid.exists)),
                            hn::AndNot(bits_from(solid.to), bits_from(solid.from)));
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
