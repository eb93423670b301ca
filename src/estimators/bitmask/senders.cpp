// SPDX-License-Identifier: Apache-2.0
//
// What each pixel sends to others: its albedo times all the light that arrives there. Compiled once
// for every instruction set.
//
// The unseen side of a surface has the light from its side, as far as the seen one is open. That
// senders which face away send nothing, as in the sources of the method, left five of seven frames
// too dark by a fifth and more.
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
      const V3 back = set(glm::vec3(0)) - load_normals(scene, i, depth == depth);
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
