// SPDX-License-Identifier: Apache-2.0
//
// The radiance that each pixel sends to others: its albedo times all light that arrives there.
// Compiled once for every instruction set.
//
// The back side of a surface, which the camera does not see, is assumed to receive the unoccluded
// light of its own hemisphere times the ao of the front. The sources of the method let surfaces
// that face away from a receiver send nothing: with that, five of seven frames were too dark by 20
// % or more.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/bitmask/senders.cpp"
#include <hwy/foreach_target.h>

#include "estimators/bitmask/lanes-inl.h"
#include "scene/light/light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

void sent_by_pixels(const SenderJob& job, const Window& part) {
  const MarchScene& scene = job.scene;
  for_each_vector(scene, part, [&](const Place& place) HWY_ATTR {
    const std::ptrdiff_t i = place.index;
    const V depth = load(scene.depth(), i);
    const V3 albedo = load(*job.albedo, i);
    V3 bounce = set(glm::vec3(0));
    if (job.bounce) bounce = load(*job.bounce, i);
    const auto send = [&](const V3& light, InterleavedVectors& to)
                          HWY_ATTR { store(within_range(albedo * (light + bounce)), to, i); };
    if (job.sent_back) {
      const V3 back = set(glm::vec3(0)) - load_normals(scene.normal, i, holds_solid(depth));
      send(unoccluded(job.light, back) * load(*job.ao, i), *job.sent_back);
    }
    send(load(*job.direct, i), *job.sent);
  });
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(sent_by_pixels);

void find_senders(const SenderJob& job, const Window& part) {
  HWY_DYNAMIC_DISPATCH(sent_by_pixels)(job, part);
}

}  // namespace ssdo
#endif
