// SPDX-License-Identifier: Apache-2.0
//
// How much of what a rough surface mirrors is not blocked: rays go where the facets mirror the
// viewer's direction. For specular light, the weight of each ray is the part of its light that its
// facet mirrors, channel by channel:
//
//   S = sum_open w_i L(w_i) / sum_all w_i L(w_i),   H = sum_met w_i sent_i / sum_all w_i
//   w_i = F(w_i) G1(w_i)
//
// For a prior, the shares of the sky's light that come along guessed rays are found as well, of the
// mean over the channels.
//
// L is the sky as mirrored_light-inl.h has it, sent_i the radiance of the surface in the pixel
// where the ray ends, of its back if the ray meets the back. Surfaces that go on beyond the border
// send what their border pixels send; surfaces that only other views show send nothing. Compiled
// once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/bitmask/rays/reflection.cpp"
#include <hwy/foreach_target.h>

#include <algorithm>
#include <glm/matrix.hpp>
#include <limits>
#include <memory>

#include "estimators/bitmask/rays/block-inl.h"
#include "estimators/bitmask/rays/ray-inl.h"
#include "estimators/guessed.h"
#include "estimators/microfacets.h"
#include "estimators/specular/mirrored_light-inl.h"
#include "math/frame.h"
#include "math/sobol.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// What a facet of each lane, chosen by one point of the unit square, mirrors to the viewer: the
/// direction, unit; the share of the light from there that other facets do not block, 0 below the
/// surface; the cosine to the facet; and the density of the direction.
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

/// What the surfaces that rays meet after `way` send to the receivers.
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
  const OverviewPixels met{pixel(x, scene.layout.width()), pixel(y, scene.layout.height())};
  const VI index = index_of(scene.layout, met);
  const M shown = hn::And(way < set(kFarAway), holds_solid(gather(scene.depth().data(), index)));
  if (!any(shown)) return set(glm::vec3(0));
  V3 sent{gather((*job.sent)[0].data(), index), gather((*job.sent)[1].data(), index),
          gather((*job.sent)[2].data(), index)};
  if (job.two_sided) {
    const V tilt = gather(scene.tilt.data(), index);
    const V3 normal =
        normal_of_tilt(scene, {unpack_bf16_first(tilt), unpack_bf16_second(tilt)}, slope);
    sent = if_then_else(dot(normal, to) < set(0), front_of(sent), back_of(sent));
  }
  return if_then_else_zero(shown, sent);
}

/// What surfaces that go on beyond the border send to the receivers: the mean of those that rays
/// may meet, by how likely that is.
struct SentBeyond {
  const BorderValues* sent;  ///< three; null: nothing
  V3 sum;
  V likely;

  HWY_INLINE explicit SentBeyond(const BorderValues* from)
      : sent(from), sum(set(glm::vec3(0))), likely(set(0)) {}
  HWY_INLINE void add(const Border& border, V meets) {
    if (!sent) return;
    sum = mul_add(V3{border(sent[0]), border(sent[1]), border(sent[2])}, meets, sum);
    likely = likely + meets;
  }
  HWY_INLINE V3 mean() const {
    return sum * hn::IfThenElseZero(likely > set(0), set(1) / hn::Max(likely, set(1e-20f)));
  }
};

/// Whether it is asked if the k-th rays of a member of the pattern are guessed. One in four tells
/// enough: what is made of it changes slowly. Which one differs from member to member, so that they
/// are spread as all rays are.
HWY_INLINE bool is_looked_at(int rank, int k) {
  return (k & 3) == (rank / (Interleaving::kMembers / 4) & 3);
}

/// Whether the rays of a vector of pixels are guessed, 1 or 0, the k-th of each.
HWY_INLINE V guessed_rays(const GuessedRays& guesses, const ReflectionJob& job,
                          const MarchReceiver& p, const Mirrored& m, int sample) {
  const MarchScene& scene = job.march.scene;
  alignas(64) int columns[kLanes];
  hn::Store(columns_of(scene, p.place), DI(), columns);
  const Lanes3 to(m.to);
  const Lanes looks(hn::IfThenElse(hn::And(p.valid, m.share > set(0)), set(1), set(0)));
  return by_lane([&](int lane) {
    return looks[lane] > 0 &&
           guesses.is_guessed(scene.surfaces.index(columns[lane], p.place.y), to[lane], sample);
  });
}

HWY_INLINE V mean_of(const V3& color) { return (color.x + color.y + color.z) * set(1.0f / 3); }

/// The sums of the head of this file.
struct MirroredSums {
  V3 open, all, met, weights;
  V looked_at, guessed, guessed_open;  ///< of the rays that is_looked_at() selects

  /// Adds a ray; returns w_i L(w_i).
  template <bool kOrthographic>
  HWY_INLINE V3 add(const ReflectionJob& job, const MarchReceiver& p, const V3& f0,
                    const Mirrored& m, const RayVisibility& a, const SentBeyond& beyond) {
    const MirroredLightJob& light = *job.light;
    const V3 weight = if_then_else_zero(m.share > set(0), fresnel(f0, m.facing) * m.share),
             seen = weight * look_up(light.model.sky, m.to, set(1 / float(job.rays)) / m.density);
    weights = weights + weight;
    all = all + seen;
    open = mul_add(seen, a.share, open);
    if (light.sent)
      met = met + weight * mul_add(beyond.mean(), a.lost_beyond,
                                   sent_from<kOrthographic>(light, job.march.scene, p, m.to,
                                                            a.blocked_at));
    return seen;
  }

  /// `seen` of a ray of which the share `arrives`; `is_guessed` is 1 or 0.
  HWY_INLINE void add_guess(const V3& seen, V arrives, V is_guessed) {
    const V whole = mean_of(seen), part = whole * is_guessed;
    looked_at = looked_at + whole;
    guessed = guessed + part;
    guessed_open = hn::MulAdd(part, arrives, guessed_open);
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
    if (!job.guesses) return;
    store(part(guessed, looked_at, zero), *job.guessed, i);
    store(part(guessed_open, looked_at, zero), *job.guessed_open, i);
  }
};

/// Rays of a block to what is mirrored, and what they have found.
struct BlockOfMirrors {
  BlockVectors to;
  BlockValues share, facing, density;  ///< as Mirrored has them
  BlockValues open, all;
  BlockVectors open_sky, all_sky, met, weights;
  BlockValues looked_at, guessed, guessed_open;

  HWY_INLINE void clear(int i) {
    for (BlockValues* sum : {&open, &all, &looked_at, &guessed, &guessed_open})
      sum->set_at(i, set(0));
    for (BlockVectors* sum : {&open_sky, &all_sky, &met, &weights})
      sum->set_at(i, set(glm::vec3(0)));
  }
  HWY_INLINE void put(int i, const Mirrored& m) {
    to.set_at(i, m.to), share.set_at(i, m.share);
    facing.set_at(i, m.facing), density.set_at(i, m.density);
  }
  HWY_INLINE Mirrored mirrored(int i) const { return {to(i), share(i), facing(i), density(i)}; }
  HWY_INLINE MirroredSums light(int i) const {
    return {open_sky(i), all_sky(i), met(i), weights(i), looked_at(i), guessed(i), guessed_open(i)};
  }
  HWY_INLINE void set_light(int i, const MirroredSums& sums) {
    open_sky.set_at(i, sums.open), all_sky.set_at(i, sums.all);
    met.set_at(i, sums.met), weights.set_at(i, sums.weights);
    looked_at.set_at(i, sums.looked_at);
    guessed.set_at(i, sums.guessed), guessed_open.set_at(i, sums.guessed_open);
  }
};

template <bool kOrthographic>
HWY_INLINE Ray ray_of(const MarchScene& scene, const MarchReceiver& p, const Mirrored& m) {
  return make_ray<kOrthographic>(scene, p, m.to, set(std::numeric_limits<float>::infinity()),
                                 hn::And(p.valid, m.share > set(0)));
}

/// The k-th rays of all pixels of a block are followed together: as points of Sobol's sequence,
/// they lie in the same part, one in so many, of what facets mirror, and so near to each other.
template <bool kOrthographic>
void reflection(const ReflectionJob& job, const Window& part) {
  const MarchScene& scene = job.march.scene;
  Occluders<kOrthographic> occluders(job.march, job.bounds);
  const auto mirrors = std::make_unique<BlockOfMirrors>();
  const OffscreenVisibilityLanes pass{set(1), 0, true};
  const auto receiver = [&](const Place& place) HWY_ATTR {
    MarchReceiver p = load_receiver(scene, place);
    p.reach_px = reach_px(scene, p, job.march.radius);
    return p;
  };
  for_each_block(scene, part, [&](const Block& block) HWY_ATTR {
    for_each_vector(scene, block.part,
                    [&](const Place& place) HWY_ATTR { mirrors->clear(block.first_of(place)); });
    for (int k = 0; k < job.rays; ++k) {
      occluders.clear();
      for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
        const MarchReceiver p = receiver(place);
        const Lanes3 normals(usable(load_shading(scene, place).normal, p.valid)),
            viewers(if_then_else(p.valid, p.to_viewer, set(glm::vec3(0, 0, 1))));
        const Lanes roughness(hn::IfThenElse(p.valid, load(*job.roughness, place.index), set(1)));
        // All members together cover the square evenly.
        const int sample = SlicePattern::rank(member_at(scene, place)) * job.rays + k;
        const Mirrored m = mirrored(normals, viewers, roughness,
                                    sobol_point(std::uint32_t(sample), hash_of(job.seed, 0, 0)));
        mirrors->put(block.first_of(place), m);
        occluders.ask(block.first_of(place), p, ray_of<kOrthographic>(scene, p, m));
      });
      occluders.run(false);
      for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
        const MarchReceiver p = receiver(place);
        const int i = block.first_of(place);
        const Mirrored m = mirrors->mirrored(i);
        SentBeyond beyond(job.light ? job.light->sent_border : nullptr);
        const RayVisibility a = occluders.visibility(i, p, ray_of<kOrthographic>(scene, p, m), pass,
                                                     [&](const Border& border, V likely)
                                                         HWY_ATTR { beyond.add(border, likely); });
        mirrors->open.set_at(i, hn::MulAdd(a.share, m.share, mirrors->open(i)));
        mirrors->all.set_at(
            i, mirrors->all(i) + hn::IfThenElseZero(p.valid, hn::Max(m.share, set(0))));
        if (!job.light) return;
        MirroredSums light = mirrors->light(i);
        const V3 seen =
            light.add<kOrthographic>(job, p, f0_at(*job.light, scene, place), m, a, beyond);
        const int rank = SlicePattern::rank(member_at(scene, place));
        if (job.light->guesses && is_looked_at(rank, k))
          light.add_guess(seen, a.share,
                          guessed_rays(*job.light->guesses, job, p, m, rank * job.rays + k));
        mirrors->set_light(i, light);
      });
    }
    for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
      const int i = block.first_of(place);
      const V open = mirrors->open(i), all = mirrors->all(i);
      const V share = hn::IfThenElse(all > set(0), open / hn::Max(all, set(1e-20f)), set(1));
      if (job.open) store(share, *job.open, place.index);
      if (job.light) mirrors->light(i).store_at(*job.light, share, place.index);
    });
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
