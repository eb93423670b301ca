// SPDX-License-Identifier: Apache-2.0
//
// How much of what a rough surface mirrors is not blocked: rays to what the facets show that the
// viewer sees. Compiled once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/bitmask/rays/reflection.cpp"
#include <hwy/foreach_target.h>

#include <algorithm>
#include <glm/matrix.hpp>
#include <limits>

#include "estimators/bitmask/rays/ray-inl.h"
#include "estimators/microfacets.h"
#include "math/frame.h"
#include "math/sobol.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// What the facets of each lane mirror to the viewer for one point of the unit square: unit
/// directions, and how much of it other facets leave; 0 where it lies below the surface.
struct Mirrored {
  V3 to;
  V share;
};

HWY_INLINE Mirrored mirrored(const Lanes3& normals, const Lanes3& viewers, const Lanes& roughness,
                             const glm::vec2& u) {
  alignas(64) float x[kLanes], y[kLanes], z[kLanes], share[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) {
    const glm::mat3 frame = frame_about(normals[lane]);
    const FacetSample sample = mirror_at_facet(viewers[lane] * frame, roughness[lane], u);
    const glm::vec3 to = frame * sample.to;
    x[lane] = to.x, y[lane] = to.y, z[lane] = to.z;
    share[lane] = sample.share;
  }
  return {{load(x), load(y), load(z)}, load(share)};
}

template <bool kOrthographic>
void reflection(const ReflectionJob& job, const Window& part) {
  constexpr int kTogether = 8;  // rays of each pixel on their way at once
  const MarchScene& scene = job.march.scene;
  Occluders<kOrthographic> occluders(job.march, job.bounds, kTogether * kLanes);
  const auto places = [](int k) HWY_ATTR { return hn::Iota(DI(), k * kLanes); };
  Ray rays[kTogether];
  V shares[kTogether];
  for_each_vector(scene, part, [&](const Place& place) HWY_ATTR {
    const int member = member_at(scene, place);
    MarchReceiver p = load_receiver(scene, place);
    p.reach_px = reach_px(scene, p, job.march.radius);
    const Lanes3 normals(usable(load_shading(scene, place).normal, p.valid)),
        viewers(if_then_else(p.valid, p.to_viewer, set(glm::vec3(0, 0, 1))));
    const Lanes roughness(hn::IfThenElse(p.valid, load(*job.roughness, place.index), set(1)));
    V open = set(0), all = set(0);
    for (int first = 0; first < job.rays; first += kTogether) {
      const int count = std::min(kTogether, job.rays - first);
      occluders.clear();
      for (int k = 0; k < count; ++k) {
        // All members together cover the square evenly.
        const int sample = SlicePattern::rank(member) * job.rays + first + k;
        const Mirrored m = mirrored(normals, viewers, roughness,
                                    sobol_point(std::uint32_t(sample), hash_of(job.seed, 0, 0)));
        shares[k] = m.share;
        rays[k] =
            make_ray<kOrthographic>(scene, p, m.to, set(std::numeric_limits<float>::infinity()),
                                    hn::And(p.valid, m.share > set(0)));
        occluders.ask(places(k), p, rays[k]);
      }
      occluders.run();
      for (int k = 0; k < count; ++k) {
        const Arrival a = occluders.arrival(places(k), p, rays[k], PassBeyond{});
        open = hn::MulAdd(a.share, shares[k], open);
        all = all + hn::IfThenElseZero(p.valid, hn::Max(shares[k], set(0)));
      }
    }
    const V share = hn::IfThenElse(all > set(0), open / hn::Max(all, set(1e-20f)), set(1));
    store(share, *job.open, place.index);
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
