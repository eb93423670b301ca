// SPDX-License-Identifier: Apache-2.0
//
// How likely two pixels show one surface, for a vector of pixels; see geometry_filter.cpp. Compiled
// once for every instruction set.
#if defined(SSDO_FILTERS_SIMILARITY_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SSDO_FILTERS_SIMILARITY_INL_H_
#undef SSDO_FILTERS_SIMILARITY_INL_H_
#else
#define SSDO_FILTERS_SIMILARITY_INL_H_
#endif

#include "filters/tile_rows-inl.h"
#include "scene/same_surface-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Signed distance of q from p's tangent plane.
HWY_INLINE V above_plane(const Shown& p, const Shown& q) {
  return dot(q.position - p.position, p.normal);
}

/// The factor of w that depends on the plane, with `above` = n_p . (q - p) and the distance by
/// which rounding may have moved it. Not inlined, since it is rarely needed: for most neighbours a
/// comparison of squares shows that the factor is 1.
static HWY_NOINLINE V plane_ramp(V above, V rounding, V distance2, const Shown& p, const Shown& o) {
  const V off_plane = hn::Max(set(0), hn::Abs(above) - rounding),
          bend = hn::Max(set(0), hn::Abs(above + above_plane(p, o)) - rounding - rounding);
  const M exists = dot(o.normal, o.normal) > set(0);
  const V h = hn::IfThenElse(exists, hn::Min(off_plane, bend), off_plane);
  return hn::IfThenElse(distance2 > set(0), plane_weight(h / hn::Sqrt(distance2)), set(1));
}

/// w(p, q); 0 where one of them shows no surface. `opposite()` gives the pixel on p's other side.
template <class Opposite>
HWY_INLINE V similarity(const Shown& p, const Shown& q, const Opposite& opposite) {
  const V turn = normal_weight(dot(p.normal, q.normal));
  const V3 to_q = q.position - p.position;
  const V distance2 = dot(to_q, to_q), above = above_plane(p, q);
  const V rounding = p.rounding + q.rounding;
  const V off_plane = hn::Max(set(0), hn::Abs(above) - rounding);
  if (all(within_sine(off_plane, distance2, kPlaneSine / 2))) return turn;
  return turn * plane_ramp(above, rounding, distance2, p, opposite());
}

/// v(p, q): how far both face alike, and each lies in the other's plane; 0 where one of them shows
/// no surface. Wider than w, which other surfaces do not pass.
/// A backdrop far behind p may lie in the plane of p, but not p in that of the backdrop.
HWY_INLINE V resemblance(const Shown& p, const Shown& q) {
  const V3 to_q = q.position - p.position;
  const V distance2 = dot(to_q, to_q);
  const V sine = hn::Max(hn::Abs(above_plane(p, q)), hn::Abs(above_plane(q, p))) /
                 hn::Sqrt(hn::Max(distance2, set(1e-30f)));
  return saturate(dot(p.normal, q.normal)) * saturate(set(1) - sine);
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
