// SPDX-License-Identifier: Apache-2.0
//
// Reflection occlusion by cones: Jimenez et al., "Practical Realtime Strategies for Accurate
// Indirect Occlusion", 2016, section 6, in the form that engines run.
//
// A rough surface mirrors a cone of directions about the reflected direction r; a cone about the
// bent normal b is visible. Their angles are s = max(roughness, 0.1) pi and u = |b| pi strength;
// with w the angle between r and b, D = |s - u| and S = s + u,
//
//   share = smoothstep(1 - saturate((w - D) / (S - D))) saturate((u - 0.1) / 0.2)
//
// of the narrower cone is in the other: 1 where it lies within, 0 where they do not touch, or where
// the visible cone is all but closed. b must not be made unit before.
//
// What differs, and why:
// - Engines take this share for the result, so that a narrow visible cone within a wide specular
//   cone counts as open. Here the share is made a solid angle, times 1 - cos min(s, u), as Oat and
//   Sander have it, from whom the smoothstep is ("Ambient aperture lighting", 2007): the RMSE
//   against rays halves at a roughness of 0.5.
// - The result is that solid angle over the one of an open surface, whose b is N. At grazing angles
//   a part of the specular cone is below the surface, which by itself reads as hidden: 0.7 is left
//   of an open plane at 10 degrees of elevation and a roughness of 0.2.
//
// Known fault, kept: s reaches pi, beyond the surface, for a roughness of 1.
#include "estimators/view_space/reflection_occlusion.h"

#include <numbers>

#include "estimators/view_space/openness.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/view_space/reflection_occlusion.cpp"
#include <hwy/foreach_target.h>

#include "estimators/view_space/lanes-inl.h"
// After the targets' headers.
#include <hwy/contrib/math/math-inl.h>

#ifndef SSDO_REFLECTION_JOB_
#define SSDO_REFLECTION_JOB_
namespace ssdo {

struct ReflectionJob {
  const ViewPlanes& planes;
  const Plane<glm::vec3>& bent;
  const Plane<float>* layer;  ///< of roughness; null: the number
  float roughness, strength;
};

// In radians, of the visible cone; the roughness of the narrowest specular cone.
constexpr float kClosed = 0.1f, kOpening = 0.2f, kSharpest = 0.1f;

}  // namespace ssdo
#endif

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The solid angle over 2 pi of a cone of `specular` about the unit vector r that is in one of
/// `visible` about b.
HWY_INLINE V overlap_of_cones(V specular, const V3& r, V visible, const V3& b, V length) {
  const V cosine = dot(b, r) / hn::Max(length, set(1e-20f));
  const V between = hn::Acos(D(), hn::Min(hn::Max(cosine, set(-1)), set(1)));
  // S - D is twice the smaller angle.
  const V apart = (between - hn::Abs(specular - visible)) / (set(2) * hn::Min(specular, visible));
  const V opened = hn::Min((visible - set(kClosed)) / set(kOpening), set(1));
  const V narrower = set(1) - hn::Cos(D(), hn::Min(specular, visible));
  const V overlap = smoothstep(set(0), set(1), set(1) - saturate(apart)) * opened * narrower;
  return hn::IfThenElseZero(visible > set(kClosed), overlap);
}

void reflection_of_tile(const ReflectionJob& job, const Tile& tile, Plane<float>& open) {
  const ViewPlanes& planes = job.planes;
  const V pi = set(float(std::numbers::pi)), strength = set(job.strength) * pi;
  set_openness(planes, tile, open, [&](const ViewReceiver& p, int x, int y) HWY_ATTR {
    const V3 viewer = direction_to_viewer(planes, p);
    // What a mirror there shows the viewer.
    const V3 r = p.normal * (set(2) * dot(p.normal, viewer)) - viewer;
    const int count = tile.x1 - x;
    const V3 b = load_first(count, &job.bent(x, y));
    const V roughness = job.layer ? load_first(count, &(*job.layer)(x, y)) : set(job.roughness);
    const V length = hn::Sqrt(dot(b, b));
    const V specular = hn::Max(roughness, set(kSharpest)) * pi;
    const V overlap = overlap_of_cones(specular, r, length * strength, b, length),
            of_open = overlap_of_cones(specular, r, strength, p.normal, set(1));
    return hn::Min(overlap / hn::Max(of_open, set(1e-20f)), set(1));
  });
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(reflection_of_tile);

Plane<float> reflection_occlusion(const Scene& scene, const Request& request,
                                  const ViewPlanes& planes, const Plane<glm::vec3>& bent,
                                  float strength) {
  const bool layer = !scene.roughness.empty();
  const ReflectionJob job{planes, bent, layer ? &scene.roughness : nullptr,
                          float(request.parameters.at("roughness")), strength};
  return find_openness(planes, {}, [&](const Tile& tile, Plane<float>& open) {
    HWY_DYNAMIC_DISPATCH(reflection_of_tile)(job, tile, open);
  });
}

}  // namespace ssdo
#endif
