// SPDX-License-Identifier: Apache-2.0
//
// The direct light of each pixel, and the radiance that it sends to others: its albedo times all
// light that arrives there. The light that arrives is a mean over 4 x 4 pixels of the same surface.
// The light of a single pixel comes from two slices and one ray to each sun, and many receivers
// look at the same pixel: without the mean, the noise of the bounce was 1.6 to 1.9 times as large
// (things on a table, a box of a room). Compiled once for every instruction set.
//
// The side of a body that the camera does not see (scene/solids/unseen_side.h) is assumed to
// receive the unoccluded light of the hemisphere of the visible side's mirror image times the ao of
// the visible side; but from a lamp, which may be nearer than the solid is thick, the light that
// rays find there (SourceVisibility::unseen). In the papers of the method, surfaces that face away
// from a receiver send nothing: with that, five of seven frames were too dark by 20 % or more.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/bitmask/senders.cpp"
#include <hwy/foreach_target.h>

#include "estimators/bitmask/rays/unseen_side-inl.h"
#include "scene/light/light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Pixels of a mean, in rows and columns: members of any 4 x 4 of the pattern divide the directions
/// evenly.
constexpr int kWindow = 4;

/// The pixels around each pixel of a vector, and their weights in a mean over its surface.
struct Around {
  std::ptrdiff_t index[kWindow * kWindow];
  V weight[kWindow * kWindow];
  int count = 0;
  V all;  ///< sum of the weights

  HWY_INLINE void add(std::ptrdiff_t q, V weight_of_q) {
    index[count] = q, weight[count++] = weight_of_q;
    all = all + weight_of_q;
  }

  /// The mean of value(index).
  template <class Value>
  HWY_INLINE V mean(const Value& value) const {
    V sum = set(0);
    for (int k = 0; k < count; ++k) {
      const V counted = hn::IfThenElseZero(weight[k] > set(0), value(index[k]));
      sum = hn::MulAdd(counted, weight[k], sum);
    }
    return sum / all;
  }
};

template <bool kOrthographic>
HWY_INLINE Around around(const MarchScene& scene, const Place& place) {
  const MarchReceiver p = load_receiver(scene, place);
  Around pixels;
  pixels.all = set(0);
  for (int dy = -kWindow / 2; dy < kWindow / 2; ++dy) {
    if (place.y + dy < 0 || place.y + dy >= scene.layout.height()) continue;
    for (int dx = -kWindow / 2; dx < kWindow / 2; ++dx) {
      const std::ptrdiff_t q = place_beside(scene.layout, place, dx, dy).index;
      const V weight = dx == 0 && dy == 0 ? set(1) : likeness<kOrthographic>(scene, p, q, dx, dy);
      if (any(weight > set(0))) pixels.add(q, weight);
    }
  }
  return pixels;
}

/// The normals by which light is weighed.
HWY_INLINE V3 shading_normals(const MarchScene& scene, const Place& place) {
  const M valid = holds_solid(load(scene.receiver_depth(), place.index));
  return usable(load_shading(scene, place).normal, valid);
}

/// The share of a source's light that the surfaces in these pixels take.
HWY_INLINE V link_weight(const MarchScene& scene, const Source& source, const Place& place) {
  if (!source.receivers) return set(1);
  return gather(&(*source.receivers)(0, place.y), columns_of(scene, place));
}

/// The positions of the surfaces in these pixels.
HWY_INLINE V3 positions(const MarchScene& scene, const Place& place) {
  const auto& [x, y, z] = scene.surfaces.position;
  const VI at = columns_of(scene, place);
  return {gather(&x(0, place.y), at), gather(&y(0, place.y), at), gather(&z(0, place.y), at)};
}

/// The direct light of pixels. `share(planes...)`, for the sum of the planes, is the share of the
/// sky's light that arrives; `of_source(plane)` is that of a source.
template <class Share, class OfSource>
HWY_INLINE V3 direct_light(const MarchScene& scene, const InterleavedVisibility& found,
                           const Place& place, const Share& share, const OfSource& of_source) {
  const V3 normal = shading_normals(scene, place);
  const V3 sky = unoccluded_sky(found.light, normal);
  if (!found.sky) return sky * share(*found.ao);
  const InterleavedPlane& ao = *found.ao;
  const InterleavedColorRatios& more = *found.sky;
  V3 sum = sky * V3{share(ao, more[0]), share(ao, more[1]), share(ao, more[2])};
  const V3 position = positions(scene, place);
  for (std::size_t k = 0; k < found.sources.size(); ++k) {
    const Source& source = *found.light.sources[k];
    const V3 light = unoccluded(source, position, normal) * link_weight(scene, source, place);
    sum = mul_add(light, of_source(found.sources[k]->share), sum);
  }
  return sum;
}

/// The direct light of the sides that the camera does not see.
template <class Share, class OfSource>
HWY_INLINE V3 light_behind(const SenderJob& job, const Place& place, const Share& share,
                           const OfSource& of_source) {
  const InterleavedVisibility& found = job.found;
  const MarchReceiver p = load_receiver(job.scene, place);
  const UnseenSide side = unseen_side(job.scene, p);
  const V3 position = positions(job.scene, place), normal = usable(side.normal, p.valid),
           mirrored = usable(side.mirrored, p.valid),
           opposite = if_then_else(hn::And(p.valid, side.ends), side.position, position);
  V3 as_sky = unoccluded_sky(found.light, mirrored), sum = set(glm::vec3(0));
  for (std::size_t k = 0; k < found.light.sources.size(); ++k) {
    const Source& source = *found.light.sources[k];
    const V taken = link_weight(job.scene, source, place);
    if (found.sources.empty() || !found.sources[k]->unseen.data()) {
      as_sky = mul_add(unoccluded(source, position, mirrored), taken, as_sky);
      continue;
    }
    const V arrives = hn::IfThenElseZero(side.ends, of_source(found.sources[k]->unseen)) * taken;
    sum = mul_add(unoccluded(source, opposite, normal), arrives, sum);
  }
  return mul_add(as_sky, share(*found.ao), sum);
}

HWY_INLINE V3 both_sides(const V3& front, const V3& back) {
  return {pack_bf16x2(front.x, back.x), pack_bf16x2(front.y, back.y), pack_bf16x2(front.z, back.z)};
}

HWY_INLINE V3 albedo_at(const SenderJob& job, const Place& place) {
  const HalfColor* row = &job.albedo(0, place.y);
#if HWY_TARGET == HWY_SCALAR
  return set(glm::vec3(row[columns_of(job.scene, place).raw]));
#else
  const VI bytes = columns_of(job.scene, place) * set_int(sizeof(HalfColor));
  const auto pair = [&](const std::uint16_t& first) HWY_ATTR {
    return hn::BitCast(DU(), hn::GatherOffset(DI(), reinterpret_cast<const int*>(&first), bytes));
  };
  const auto value = [](VU half) HWY_ATTR {
    return hn::BitCast(D(), hn::ShiftLeft<HalfColor::kShift>(half)) * set(HalfColor::kScale);
  };
  const VU red_green = pair(row->r), green_blue = pair(row->g), low = set_bits(0xffff);
  return {value(hn::And(red_green, low)), value(hn::And(green_blue, low)),
          value(hn::ShiftRight<16>(green_blue))};
#endif
}

/// How a prior that changes ao changes the light that arrives (prior/prior.h): factors of the light
/// from outside and of the bounce, and the radiance that is added to the bounce.
struct Unshown {
  V of_light, of_bounce;
  V3 sent;
};
HWY_INLINE Unshown unshown_of(const SenderJob& job, V ao, V change) {
  const V least = set(1e-2f), one = set(1), after = saturate(ao + change);
  const V closer = hn::Max(ao - after, set(0)),
          opener = (one - hn::Max(after, ao)) / hn::Max(one - ao, least);
  return {(after + least) / (ao + least), hn::Min(opener, one), set(job.sent_before) * closer};
}

template <bool kOrthographic>
void send_light(const SenderJob& job, const Window& part) {
  const MarchScene& scene = job.scene;
  for_each_vector(scene, part, [&](const Place& place) HWY_ATTR {
    const std::ptrdiff_t i = place.index;
    const Around pixels = around<kOrthographic>(scene, place);
    const auto mean = [&](const InterleavedPlane& plane) HWY_ATTR {
      return pixels.mean([&](std::ptrdiff_t q) HWY_ATTR { return load(plane, q); });
    };
    const auto mean_share = [&](const auto&... planes) HWY_ATTR {
      return pixels.mean([&](std::ptrdiff_t q)
                             HWY_ATTR { return saturate((load(planes, q) + ...)); });
    };
    Unshown unshown{set(1), set(1), set(glm::vec3(0))};
    if (job.change) unshown = unshown_of(job, mean(*job.found.ao), load(*job.change, i));
    const auto share = [&](const auto&... planes) HWY_ATTR {
      return job.change ? saturate(mean_share(planes...) * unshown.of_light)
                        : mean_share(planes...);
    };
    V3 light = direct_light(scene, job.found, place, share, mean_share);
    if (job.bounce) {
      const auto& [red, green, blue] = *job.bounce;
      const V3 bounce{mean(red), mean(green), mean(blue)};
      light = light + (job.change ? mul_add(bounce, unshown.of_bounce, unshown.sent) : bounce);
    }
    const V3 albedo = albedo_at(job, place);
    const V3 front = within_range(albedo * light);
    if (!job.two_sided) return store(front, *job.sent, i);
    const V3 bounce = job.bounce ? load(*job.bounce, i) : set(glm::vec3(0));
    const V3 at_back = light_behind(job, place, share, mean_share) + bounce;
    store(both_sides(front, within_range(albedo * at_back)), *job.sent, i);
  });
}

void direct_of_pixels(const DirectJob& job, const Window& part) {
  for_each_vector(job.scene, part, [&](const Place& place) HWY_ATTR {
    const auto own = [&](const auto&... planes)
                         HWY_ATTR { return saturate((load(planes, place.index) + ...)); };
    store(direct_light(job.scene, job.found, place, own, own), *job.direct, place.index);
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
HWY_EXPORT(direct_of_pixels);

void find_senders(const SenderJob& job, const Window& part) {
  HWY_DYNAMIC_DISPATCH(sent_by_pixels)(job, part);
}

void find_direct(const DirectJob& job, const Window& part) {
  HWY_DYNAMIC_DISPATCH(direct_of_pixels)(job, part);
}

}  // namespace ssdo
#endif
