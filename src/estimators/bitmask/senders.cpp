// SPDX-License-Identifier: Apache-2.0
//
// The radiance that each pixel sends to others: its albedo times all light that arrives there, a
// mean over 4 x 4 pixels of its surface. A pixel's own light comes from two slices and one ray to
// each sun, and many receivers look at the same pixel: sent on as it is, it made the noise of
// the bounce 1.6 to 1.9 times as large (things on a table, a box of a room). Compiled once for
// every instruction set.
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

/// Pixels of a mean, in rows and columns: members of any 4 x 4 of the pattern divide the directions
/// evenly.
constexpr int kWindow = 4;

/// What arrives at a vector of pixels.
struct Arriving {
  V3 light;  ///< direct and bounced
  V ao;
};

HWY_INLINE Arriving arriving_at(const SenderJob& job, std::ptrdiff_t i) {
  const V3 direct = load(*job.direct, i);
  return {job.bounce ? direct + load(*job.bounce, i) : direct, load(*job.ao, i)};
}

/// Its mean over the pixels around each, on the same surface.
template <bool kOrthographic>
HWY_INLINE Arriving mean_arriving(const SenderJob& job, const Place& place) {
  const MarchScene& scene = job.scene;
  const MarchReceiver p = load_receiver(scene, place);
  Arriving sum{set(glm::vec3(0)), set(0)};
  V weights = set(0);
  for (int dy = -kWindow / 2; dy < kWindow / 2; ++dy) {
    if (place.y + dy < 0 || place.y + dy >= scene.layout.height()) continue;
    for (int dx = -kWindow / 2; dx < kWindow / 2; ++dx) {
      const std::ptrdiff_t q = index_beside(scene.layout, place, dx, dy);
      const V weight = dx == 0 && dy == 0 ? set(1) : likeness<kOrthographic>(scene, p, q, dx, dy);
      const M counts = weight > set(0);
      if (!any(counts)) continue;
      const Arriving beside = arriving_at(job, q);
      sum.light = mul_add(if_then_else_zero(counts, beside.light), weight, sum.light);
      sum.ao = hn::MulAdd(hn::IfThenElseZero(counts, beside.ao), weight, sum.ao);
      weights = weights + weight;
    }
  }
  return {sum.light / weights, sum.ao / weights};
}

HWY_INLINE V3 albedo_at(const SenderJob& job, const Place& place) {
  const float* from = &job.albedo(0, place.y).x;
  const VI at = columns_of(job.scene, place) * set_int(3);
  return within_range(V3{gather(from, at), gather(from + 1, at), gather(from + 2, at)});
}

template <bool kOrthographic>
void send_light(const SenderJob& job, const Window& part) {
  const MarchScene& scene = job.scene;
  for_each_vector(scene, part, [&](const Place& place) HWY_ATTR {
    const std::ptrdiff_t i = place.index;
    const Arriving mean = mean_arriving<kOrthographic>(job, place);
    const V3 albedo = albedo_at(job, place);
    const auto send = [&](const V3& light, InterleavedVectors& to)
                          HWY_ATTR { store(within_range(albedo * light), to, i); };
    if (job.sent_back) {
      const M valid = holds_solid(load(scene.depth(), i));
      const V3 back = set(glm::vec3(0)) - usable(load(scene.normal, i), valid);
      const V3 bounce = job.bounce ? load(*job.bounce, i) : set(glm::vec3(0));
      send(mul_add(unoccluded(job.light, back), mean.ao, bounce), *job.sent_back);
    }
    send(mean.light, *job.sent);
  });
}

void sent_by_pixels(const SenderJob& job, const Window& part) {
  job.scene.orthographic ? send_light<true>(job, part) : send_light<false>(job, part);
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
