// SPDX-License-Identifier: Apache-2.0
//
// The light of bright senders (rays/emitters.h) at each pixel. Without occluders it is a sum over
// the pixel's points,
//
//   sum_k power_k cos_k cos'_k / (pi d_k^2 + area_k)
//
// and all of the sum arrives or none of it: a ray to one of the points decides, chosen with a
// probability proportional to its part of the sum (resampled importance sampling: Talbot, Cline and
// Egbert, 2005). So where nothing blocks the rays, the only noise is that of the points, which a
// filter over the pattern averages. Compiled once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/bitmask/rays/emitted_light.cpp"
#include <hwy/foreach_target.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "estimators/bitmask/rays/block-inl.h"
#include "estimators/bitmask/rays/ray-inl.h"
#include "math/sobol.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The point that the ray of each lane goes to, and what that stands for.
struct Chosen {
  V3 position;
  V solid;   ///< as Emitter has it
  V3 light;  ///< of all points, in the colour of this one; 0: there is none
};

/// The light that a point gives each lane without occluders, per unit of its power.
HWY_INLINE V seen_size(const March& march, const MarchReceiver& p, const Emitter& e) {
  const V zero = set(0);
  const V3 to = set(e.position) - p.position;
  const V distance2 = dot(to, to), cosine = hn::Max(dot(p.shading, to), zero),
          cosine_there = hn::Max(zero - dot(set(e.normal), to), zero);
  const V size = (cosine / distance2) *
                 (cosine_there / hn::MulAdd(distance2, set(glm::pi<float>()), set(e.area)));
  const M meets = hn::And(hn::And(p.valid, dot(p.normal, to) > zero),
                          hn::And(distance2 <= set(march.radius * march.radius), size > zero));
  return hn::IfThenElseZero(meets, size);
}

/// A choice among the points of a member of the pattern, by a number in 0..1.
struct Choice {
  int member;
  float u;
};

/// The choices of the members are evenly spread, and so are those of a pixel's rays. Rays of the
/// second set go to points of another member.
HWY_INLINE Choice choice(const EmittedJob& job, int member, int ray, int set_of_rays) {
  constexpr int kApart = 37;
  const glm::vec2 u = sobol_point(std::uint32_t(SlicePattern::rank(member)),
                                  hash_of(job.seed, std::uint32_t(set_of_rays), 7));
  return {(member + kApart * set_of_rays) % Interleaving::kMembers,
          (float(ray) + u.y) / float(job.rays)};
}

HWY_INLINE Chosen choose(const EmittedJob& job, const MarchReceiver& p, const Choice& choice) {
  constexpr int kStride = sizeof(Emitter) / sizeof(float);
  const Emitter* points = job.emitters.of_member(choice.member);
  const V zero = set(0);
  V reached[Emitters::kPoints], sum = zero;
  for (int k = 0; k < Emitters::kPoints; ++k)
    sum = reached[k] = sum + seen_size(job.march, p, points[k]);
  const V aim = sum * set(choice.u);
  VI number = set_int(0);
  for (int k = 0; k + 1 < Emitters::kPoints; ++k) {
    const auto later = hn::RebindMask(DI(), reached[k] <= aim);
    number = number + hn::IfThenElseZero(later, set_int(1));
  }
  const VI at = number * set_int(kStride);
  const auto read = [&](const float& first) HWY_ATTR { return gather(&first, at); };
  const auto read3 = [&](const glm::vec3& first) HWY_ATTR {
    return V3{read(first.x), read(first.y), read(first.z)};
  };
  // All points of a member have the same luminance.
  const V3 power = if_then_else_zero(sum > zero, read3(points->power));
  return {read3(points->position), read(points->solid), power * sum};
}

/// The rays of a block, the light that comes along them if nothing is in their way, and what of
/// that arrives.
struct EmittedRays {
  BlockVectors to, light, arrived;
  BlockValues length;
};

/// The light that arrives at a block, by rays of one of two sets that have nothing in common.
template <bool kOrthographic>
HWY_INLINE void find_arriving(const EmittedJob& job, const Block& block, int set_of_rays,
                              Occluders<kOrthographic>& occluders, EmittedRays& rays) {
  const MarchScene& scene = job.march.scene;
  const V zero = set(0);
  const auto ray = [&](const MarchReceiver& p, int i) HWY_ATTR {
    return make_ray<kOrthographic>(scene, p, rays.to(i), rays.length(i),
                                   luminance(rays.light(i)) > zero);
  };
  for (int k = 0; k < job.rays; ++k) {
    occluders.clear();
    for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
      MarchReceiver p = load_receiver(scene, place);
      p.reach_px = reach_px(scene, p, job.march.radius);
      const int i = block.first_of(place);
      const Chosen chosen = choose(job, p, choice(job, member_at(scene, place), k, set_of_rays));
      const V3 way = chosen.position - p.position;
      const V distance = hn::Sqrt(dot(way, way));
      rays.to.set_at(i, way / hn::Max(distance, set(1e-20f)));
      rays.length.set_at(i, hn::Max(distance - chosen.solid, zero));
      rays.light.set_at(i, chosen.light);
      if (k == 0) rays.arrived.set_at(i, set(glm::vec3(0)));
      occluders.ask(i, p, ray(p, i));
    });
    occluders.run(false);
    for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
      const int i = block.first_of(place);
      const MarchReceiver p = load_receiver(scene, place);
      const RayVisibility a =
          occluders.visibility(i, p, ray(p, i), OffscreenVisibilityLanes{set(1), 0});
      const V3 light = if_then_else_zero(a.share > zero, rays.light(i) * a.share);
      rays.arrived.set_at(i, mul_add(light, set(1 / float(job.rays)), rays.arrived(i)));
    });
  }
}

template <bool kOrthographic>
void emitted(const EmittedJob& job, const Window& part) {
  const MarchScene& scene = job.march.scene;
  Occluders<kOrthographic> occluders(job.march, job.bounds);
  EmittedRays rays;
  for_each_block(scene, part, [&](const Block& block) HWY_ATTR {
    // Twice where the error is wanted: it is what changes with other points and rays.
    for (int set_of_rays = 0; set_of_rays < (job.error ? 2 : 1); ++set_of_rays) {
      find_arriving<kOrthographic>(job, block, set_of_rays, occluders, rays);
      // Halves of the slices differ by the square root of 3 times the error, two sets by that of 2.
      const V sign = set(std::sqrt(1.5f) * (set_of_rays == 0 ? 1 : -1));
      for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
        const std::ptrdiff_t i = place.index;
        const V3 light = rays.arrived(block.first_of(place));
        if (set_of_rays == 0) {
          store(load(*job.light, i) + light, *job.light, i);
          if (job.emitted) store(light, *job.emitted, i);
        }
        if (job.error)
          store(hn::MulAdd(luminance(light), sign, load(*job.error, i)), *job.error, i);
      });
    }
  });
}

void emitted_to_pixels(const EmittedJob& job, const Window& part) {
  job.march.scene.orthographic ? emitted<true>(job, part) : emitted<false>(job, part);
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(emitted_to_pixels);

void gather_emitted(const EmittedJob& job, const Window& part) {
  HWY_DYNAMIC_DISPATCH(emitted_to_pixels)(job, part);
}

}  // namespace ssdo
#endif
