// SPDX-License-Identifier: Apache-2.0
//
// The light of a sun, by a ray from each pixel to a point of its disc. Compiled once for every
// instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/bitmask/sun.cpp"
#include <hwy/foreach_target.h>

#include "estimators/bitmask/ray-inl.h"
#include "scene/light/light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

template <bool kOrthographic>
void sun(const SunJob& job, const Window& part) {
  const MarchScene& scene = job.march.scene;
  for_each_vector(scene, part, [&](const Place& place) HWY_ATTR {
    const int member = member_at(scene, place);
    MarchReceiver p = load_receiver(scene, place);
    p.reach_px = reach_px(scene, p, job.march.radius);
    const V visible =
        passes<kOrthographic>(job.march, job.bounds, p, set(job.directions[std::size_t(member)]),
                              p.valid, turn_of_member(member), job.past_beyond);
    store(visible, *job.share, place.index);
    const V3 light = unoccluded(*job.sun, load_normals(scene, place.index, p.valid));
    store(mul_add(light, visible, load(*job.direct, place.index)), *job.direct, place.index);
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
