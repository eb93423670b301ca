// SPDX-License-Identifier: Apache-2.0
//
// The light of a sun, by rays from each pixel to points of it: one at few slices. Compiled once for
// every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/bitmask/sun.cpp"
#include <hwy/foreach_target.h>

#include <algorithm>
#include <cmath>

#include "estimators/bitmask/ray-inl.h"
#include "scene/light/light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Directions to points of a sun, and their cosines to the normals.
struct SunPoints {
  V3 to;
  V cosine;
};

/// The point that a ray of a member of the pattern goes to. Where that is below the horizon of a
/// lane, as part of a sun may be, another one.
HWY_INLINE SunPoints points_above(const SunJob& job, const PerMember<glm::vec3>& directions,
                                  int member, const V3& normal) {
  constexpr int kTries = 8, kApart = 9;  // members that lie apart in both directions
  const auto at = [&](int k) HWY_ATTR {
    const V3 to = set(directions[std::size_t(member + kApart * k) % directions.size()]);
    return SunPoints{to, dot(normal, to)};
  };
  SunPoints found = at(0);
  const V middle = dot(normal, set(job.sun->direction));
  const M sets = hn::Abs(middle) < set(std::sin(job.sun->angular_radius));
  for (int k = 1; k < kTries; ++k) {
    const M below = hn::And(sets, found.cosine <= set(0));
    if (!any(below)) break;
    const SunPoints other = at(k);
    found = {if_then_else(below, other.to, found.to),
             hn::IfThenElse(below, other.cosine, found.cosine)};
  }
  return found;
}

/// Width in pixels of the penumbra that something throws at this distance.
template <bool kOrthographic>
HWY_INLINE V penumbra_px(const SunJob& job, const MarchReceiver& p, V distance) {
  const MarchScene& scene = job.march.scene;
  const V width = distance * set(2 * job.sun->angular_radius * std::max(scene.fx, scene.fy));
  const V px = kOrthographic ? width : width / (set(0) - p.position.z);
  return hn::Clamp(px, set(1), set(float(Interleaving::kPeriod)));
}

template <bool kOrthographic>
void sun(const SunJob& job, const Window& part) {
  const MarchScene& scene = job.march.scene;
  for_each_vector(scene, part, [&](const Place& place) HWY_ATTR {
    const std::ptrdiff_t i = place.index;
    const int member = member_at(scene, place);
    MarchReceiver p = load_receiver(scene, place);
    p.reach_px = reach_px(scene, p, job.march.radius);
    // Means over the rays: of what arrives by their cosines, of widths by what does not.
    const V zero = set(0), rays = set(float(job.directions.size()));
    V weight = zero, arrives = zero, blocked = zero, widths = zero;
    for (const PerMember<glm::vec3>& directions : job.directions) {
      const SunPoints points = points_above(job, directions, member, p.normal);
      const M above = hn::And(p.valid, points.cosine > zero);
      if (!any(above)) continue;
      V blocked_at;
      const V passed = passes<kOrthographic>(job.march, job.bounds, p, points.to, above,
                                             turn_of_member(member), job.pass, blocked_at);
      const V cosine = hn::IfThenElseZero(above, points.cosine), lost = cosine * (set(1) - passed);
      weight = weight + cosine;
      arrives = hn::MulAdd(cosine, passed, arrives);
      blocked = blocked + lost;
      widths = hn::MulAdd(lost, penumbra_px<kOrthographic>(job, p, blocked_at), widths);
    }
    const V visible = hn::IfThenElseZero(weight > zero, arrives / weight);
    store(visible, *job.share, i);
    store(weight / rays, *job.weight, i);
    store(hn::IfThenElseZero(blocked > zero, widths / blocked), *job.width_px, i);
    if (!job.direct) return;
    const V3 light = unoccluded(*job.sun, load_normals(scene.shading, i, p.valid));
    store(mul_add(light, visible, load(*job.direct, i)), *job.direct, i);
  });
}

void sun_of_pixels(const SunJob& job, const Window& part) {
  job.march.scene.orthographic ? sun<true>(job, part) : sun<false>(job, part);
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(sun_of_pixels);

void march_sun(const SunJob& job, const Window& part) {
  HWY_DYNAMIC_DISPATCH(sun_of_pixels)(job, part);
}

}  // namespace ssdo
#endif
