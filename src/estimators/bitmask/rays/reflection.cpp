// SPDX-License-Identifier: Apache-2.0
//
// How much of what a rough surface mirrors is not blocked: rays to what the facets show that the
// viewer sees. For specular light, each ray counts by what its facet mirrors of it, channel by
// channel:
//
//   S = sum_open w_i L(w_i) / sum_all w_i L(w_i),   H = sum_met w_i sent_i / sum_all w_i
//   w_i = F(w_i) G1(w_i)
//
// L is the sky as mirrored_light-inl.h takes it, sent_i the radiance of the surface in the pixel
// where the ray ends: that of its back if it turns that to the ray. Other things in the way send
// nothing: what only other views show, and what may go on beyond the border. Compiled once for
// every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/bitmask/rays/reflection.cpp"
#include <hwy/foreach_target.h>

#include <algorithm>
#include <glm/matrix.hpp>
#include <limits>

#include "estimators/bitmask/rays/ray-inl.h"
#include "estimators/microfacets.h"
#include "estimators/specular/mirrored_light-inl.h"
#include "math/frame.h"
#include "math/sobol.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// What the facets of each lane mirror to the viewer for one point of the unit square: unit
/// directions, and how much of it other facets leave; 0 where it lies below the surface. Beside
/// it the cosine to the facet and the density of the direction.
struct Mirrored {
  V3 to;
  V share, facing, density;
};

HWY_INLINE Mirrored mirrored(const Lanes3& normals, const Lanes3& viewers, const Lanes& roughness,
                             const glm::vec2& u) {
  alignas(64) float x[kLanes], y[kLanes], z[kLanes], share[kLanes], facing[kLanes], density[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) {
    const glm::mat3 frame = frame_about(normals[lane]);
    const glm::vec3 viewer = viewers[lane] * frame;
    const FacetSample sample = mirror_at_facet(viewer, roughness[lane], u);
    const glm::vec3 to = frame * sample.to;
    x[lane] = to.x, y[lane] = to.y, z[lane] = to.z;
    share[lane] = sample.share;
    facing[lane] = glm::dot(viewer, sample.facet);
    density[lane] = density_of(sample, viewer, roughness[lane]);
  }
  return {{load(x), load(y), load(z)}, load(share), load(facing), load(density)};
}

HWY_INLINE V3 f0_at(const MirroredLightJob& job, const MarchScene& scene, const Place& place) {
  if (job.color.empty()) return set(glm::vec3(job.model.f0));
  alignas(64) int columns[kLanes];
  hn::Store(columns_of(scene, place), DI(), columns);
  glm::vec3 colors[kLanes];
  for (int lane = 0; lane < kLanes; ++lane)
    colors[lane] = glm::vec3(job.color(columns[lane], place.y));
  return load(colors);
}

/// What the surfaces send to the receivers that rays meet after `way`.
template <bool kOrthographic>
HWY_INLINE V3 sent_from(const MirroredLightJob& job, const MarchScene& scene,
                        const MarchReceiver& p, const V3& to, V way) {
  const V3 at = mul_add(to, way, p.position);
  V2 slope{at.x, at.y};
  if constexpr (!kOrthographic) {
    const V nearness = set(-1) / hn::Min(at.z, set(-1e-20f));
    slope = {at.x * nearness, at.y * nearness};
  }
  const V x = hn::MulAdd(slope.x, set(scene.fx), set(scene.axis_x - float(scene.first_x))),
          y = hn::NegMulAdd(slope.y, set(scene.fy), set(scene.axis_y - float(scene.first_y)));
  const auto pixel = [&](V place, int size) HWY_ATTR {
    return hn::NearestInt(hn::Clamp(place, set(0), set(float(size - 1))));
  };
  const Pixels met{pixel(x, scene.layout.width()), pixel(y, scene.layout.height())};
  const VI index = index_of(scene.layout, met);
  const M shown = hn::And(way < set(kFarAway), holds_solid(gather(scene.depth().data(), index)));
  if (!any(shown)) return set(glm::vec3(0));
  V3 sent{gather((*job.sent)[0].data(), index), gather((*job.sent)[1].data(), index),
          gather((*job.sent)[2].data(), index)};
  if (job.two_sided) {
    const V tilt = gather(scene.tilt.data(), index);
    const V3 normal = normal_of_tilt(scene, {first_of_two(tilt), second_of_two(tilt)}, slope);
    sent = if_then_else(dot(normal, to) < set(0), front_of(sent), back_of(sent));
  }
  return if_then_else_zero(shown, sent);
}

/// The sums of the head of this file.
struct MirroredSums {
  V3 open, all, met, weights;

  HWY_INLINE void clear() { open = all = met = weights = set(glm::vec3(0)); }

  template <bool kOrthographic>
  HWY_INLINE void add(const ReflectionJob& job, const MarchReceiver& p, const V3& f0,
                      const Mirrored& m, const Arrival& a) {
    const MirroredLightJob& light = *job.light;
    const V3 weight = if_then_else_zero(m.share > set(0), fresnel(f0, m.facing) * m.share),
             seen = weight * look_up(light.model.sky, m.to, set(1 / float(job.rays)) / m.density);
    weights = weights + weight;
    all = all + seen;
    open = mul_add(seen, a.share, open);
    if (light.sent)
      met = met + weight * sent_from<kOrthographic>(light, job.march.scene, p, m.to, a.blocked_at);
  }

  /// `unlit`: the part of the sky that is not blocked, where a channel of it has no light.
  HWY_INLINE void store_at(const MirroredLightJob& job, V unlit, std::ptrdiff_t i) const {
    const auto part = [](V some, V whole, V otherwise) HWY_ATTR {
      return hn::IfThenElse(whole > set(0), some / hn::Max(whole, set(1e-30f)), otherwise);
    };
    const V zero = set(0);
    store(V3{part(open.x, all.x, unlit), part(open.y, all.y, unlit), part(open.z, all.z, unlit)},
          *job.sky, i);
    store(V3{part(met.x, weights.x, zero), part(met.y, weights.y, zero),
             part(met.z, weights.z, zero)},
          *job.surfaces, i);
  }
};

template <bool kOrthographic>
void reflection(const ReflectionJob& job, const Window& part) {
  constexpr int kTogether = 8;  // rays of each pixel on their way at once
  const MarchScene& scene = job.march.scene;
  Occluders<kOrthographic> occluders(job.march, job.bounds, kTogether * kLanes);
  const auto places = [](int k) HWY_ATTR { return hn::Iota(DI(), k * kLanes); };
  Ray rays[kTogether];
  Mirrored mirrors[kTogether];
  MirroredSums light;
  for_each_vector(scene, part, [&](const Place& place) HWY_ATTR {
    const int member = member_at(scene, place);
    MarchReceiver p = load_receiver(scene, place);
    p.reach_px = reach_px(scene, p, job.march.radius);
    const Lanes3 normals(usable(load_shading(scene, place).normal, p.valid)),
        viewers(if_then_else(p.valid, p.to_viewer, set(glm::vec3(0, 0, 1))));
    const Lanes roughness(hn::IfThenElse(p.valid, load(*job.roughness, place.index), set(1)));
    V open = set(0), all = set(0);
    light.clear();
    const V3 f0 = job.light ? f0_at(*job.light, scene, place) : set(glm::vec3(0));
    for (int first = 0; first < job.rays; first += kTogether) {
      const int count = std::min(kTogether, job.rays - first);
      occluders.clear();
      for (int k = 0; k < count; ++k) {
        // All members together cover the square evenly.
        const int sample = SlicePattern::rank(member) * job.rays + first + k;
        const Mirrored m = mirrored(normals, viewers, roughness,
                                    sobol_point(std::uint32_t(sample), hash_of(job.seed, 0, 0)));
        mirrors[k] = m;
        rays[k] =
            make_ray<kOrthographic>(scene, p, m.to, set(std::numeric_limits<float>::infinity()),
                                    hn::And(p.valid, m.share > set(0)));
        occluders.ask(places(k), p, rays[k]);
      }
      occluders.run();
      for (int k = 0; k < count; ++k) {
        const Arrival a = occluders.arrival(places(k), p, rays[k], PassLanes{set(1), 0});
        open = hn::MulAdd(a.share, mirrors[k].share, open);
        all = all + hn::IfThenElseZero(p.valid, hn::Max(mirrors[k].share, set(0)));
        if (job.light) light.add<kOrthographic>(job, p, f0, mirrors[k], a);
      }
    }
    const V share = hn::IfThenElse(all > set(0), open / hn::Max(all, set(1e-20f)), set(1));
    if (job.open) store(share, *job.open, place.index);
    if (job.light) light.store_at(*job.light, share, place.index);
  });
}

void reflection_of_pixels(const ReflectionJob& job, const Window& part) {
  job.march.scene.orthographic ? reflection<true>(job, part) : reflection<false>(job, part);
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(reflection_of_pixels);

void march_reflection(const ReflectionJob& job, const Window& part) {
  HWY_DYNAMIC_DISPATCH(reflection_of_pixels)(job, part);
}

}  // namespace ssdo
#endif
