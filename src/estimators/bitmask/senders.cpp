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

#include "estimators/bitmask/light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

void sent_by_pixels(const SenderJob& job, const Window& part) {
  const MarchScene& scene = job.scene;
  for_each_vector(scene, part, [&](const Place& place) HWY_ATTR {
    const D d;
    const std::ptrdiff_t i = place.index;
    const V depth = hn::LoadU(d, scene.depth().data() + i);
    const Color albedo = load_color(*job.albedo, i);
    Color bounce = set_color(glm::vec3(0));
    if (job.bounce) bounce = load_color(*job.bounce, i);
    const auto send = [&](const Color& light, InterleavedColor& to) HWY_ATTR {
      const Color all = mul_add(light, hn::Set(d, 1.0f), bounce);
      store_color(within_range(product(albedo, all)), to, i);
    };
    if (job.sent_back) {
      const Normals back = load_normals(scene, i, depth == depth).turned();
      Color light = look_up(*job.irradiance, back);
      for (const Sun& sun : job.suns)
        light = mul_add(set_color(sun.irradiance), back.facing(sun.direction), light);
      send(scaled(light, hn::LoadU(d, job.ao->data() + i)), *job.sent_back);
    }
    send(load_color(*job.direct, i), *job.sent);
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
