// SPDX-License-Identifier: Apache-2.0
//
// The light of bright senders (rays/emitters.h) at each pixel. Without occluders it is a sum over
// the pixel's points,
//
//   sum_k power_k cos_k cos'_k / (pi d_k^2 + area_k)
//
// and all of it arrives or none, as a ray finds to one of the points, which is taken as often as it
// gives of the sum (resampled importance sampling: Talbot, Cline and Egbert, 2005). So where
// nothing is in the way there is no noise but that of the points, which a filter over the pattern
// averages. Compiled once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/bitmask/rays/emitted_light.cpp"
#include <hwy/foreach_target.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "estimators/bitmask/rays/ray-inl.h"
#include "math/sobol.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Pixels whose rays are on their way together: a vector wide and kRows high.
struct EmittedBlock {
  static constexpr int kRows = 4, kWidth = Interleaving::kPeriod * kLanes, kPixels = kRows * kWidth;
  Window part;

  /// The first of the numbers that the pixels of a vector have in their order in memory.
  HWY_INLINE int first_of(const Place& at) const {
    return ((at.y - part.y0) * Interleaving::kPeriod + at.column_phase) * kLanes;
  }
  /// Numbers in which the pixels of a column of the block follow on each other.
  HWY_INLINE VI places(const Place& at) const {
    return hn::Iota(DI(), 0) * set_int(kPixels / kLanes) +
           set_int(at.column_phase * kRows + at.y - part.y0);
  }
};

/// Calls `work(block)` for the blocks of a part of the raster.
template <class Work>
HWY_INLINE void for_each_emitted_block(const MarchScene& scene, const Window& part,
                                       const Work& work) {
  constexpr int kWidth = EmittedBlock::kWidth, kRows = EmittedBlock::kRows;
  const int phase = scene.layout.phase(), first = ((part.x0 + phase) & -kWidth) - phase;
  for (int y = part.y0; y < part.y1; y += kRows) {
    for (int x = first; x < part.x1; x += kWidth) {
      work(EmittedBlock{
          {std::max(x, part.x0), y, std::min(x + kWidth, part.x1), std::min(y + kRows, part.y1)}});
    }
  }
}

/// The point that the ray of each lane goes to, and what that stands for.
struct Chosen {
  V3 position;
  V solid;   ///< as Emitter has it
  V3 light;  ///< of all points, in the colour of this one; 0: there is none
};

/// What a point gives each lane over the luminance of its power, without occluders.
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
  constexpr int kMembers = Interleaving::kPeriod * Interleaving::kPeriod, kApart = 37;
  const glm::vec2 u = sobol_point(std::uint32_t(SlicePattern::rank(member)),
                                  hash_of(job.seed, std::uint32_t(set_of_rays), 7));
  return {(member + kApart * set_of_rays) % kMembers, (float(ray) + u.y) / float(job.rays)};
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

/// How far away in the picture a point is that lies on each lane's ray.
template <bool kOrthographic>
HWY_INLINE V pixels_to(const MarchScene& scene, const MarchReceiver& p, const RayInSlice& ray,
                       const V3& point) {
  V x = point.x * set(scene.fx), y = point.y * set(scene.fy);
  if constexpr (!kOrthographic) {
    const V nearness = set(-1) / hn::Min(point.z, set(-1e-20f));
    x = x * nearness, y = y * nearness;
  }
  const V dx = x + set(scene.axis_x - float(scene.first_x)) - p.x,
          dy = set(scene.axis_y - float(scene.first_y)) - y - p.y;
  return dot(V2{dx, dy}, V2{ray.step_x, ray.step_y});
}

/// Puts the rays of a vector of receivers into a queue, and returns the light that comes along
/// them.
template <bool kOrthographic>
HWY_INLINE V3 send_rays(const EmittedJob& job, const MarchReceiver& p, const Choice& choice,
                        VI places, WalkOverFrame<kOrthographic>& walk) {
  const MarchScene& scene = job.march.scene;
  const V zero = set(0);
  const Chosen to = choose(job, p, choice);
  const M lit = luminance(to.light) > zero;
  const V3 way = to.position - p.position;
  const V distance = hn::Sqrt(dot(way, way));
  const V3 unit = way / hn::Max(distance, set(1e-20f));
  Ray ray = make_ray(scene, p, unit, lit);
  const V free = hn::Max(distance - to.solid, zero);
  if (job.march.further) {
    const Lanes3 start(start_of_rays(scene, p)), direction(unit);
    const Lanes looks(hn::IfThenElseZero(ray.open, free));
    alignas(64) float passes[kLanes];
    for (int lane = 0; lane < kLanes; ++lane) {
      passes[lane] = looks[lane] > 0 && job.march.further->is_blocked(start[lane], direction[lane],
                                                                      looks[lane])
                         ? 0.0f
                         : 1.0f;
    }
    ray.open = hn::And(ray.open, load(passes) > zero);
  }
  const V end_px =
      pixels_to<kOrthographic>(scene, p, ray.in_slice, mul_add(unit, free, p.position));
  ray.in_slice.end_px = hn::Min(ray.in_slice.end_px, end_px);
  walk.put(places, p, ray, hn::And(ray.open, end_px > set(1)));
  return if_then_else_zero(ray.open, to.light);
}

/// What the rays of a block have found, by EmittedBlock::first_of().
struct EmittedSums {
  alignas(64) float light[3][EmittedBlock::kPixels];
  alignas(64) float arrived[3][EmittedBlock::kPixels];

  HWY_INLINE V3 load_from(const float (&from)[3][EmittedBlock::kPixels], int i) const {
    return {load(from[0] + i), load(from[1] + i), load(from[2] + i)};
  }
  HWY_INLINE void store_to(float (&to)[3][EmittedBlock::kPixels], int i, const V3& value) {
    store(value.x, to[0] + i), store(value.y, to[1] + i), store(value.z, to[2] + i);
  }
};

/// The light that arrives at a block, by rays of one of two sets that have nothing in common.
template <bool kOrthographic>
HWY_INLINE void find_arriving(const EmittedJob& job, const EmittedBlock& block, int set_of_rays,
                              WalkOverFrame<kOrthographic>& walk, EmittedSums& sums) {
  const MarchScene& scene = job.march.scene;
  for (int k = 0; k < job.rays; ++k) {
    walk.clear();
    for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
      MarchReceiver p = load_receiver(scene, place);
      p.reach_px = reach_px(scene, p, job.march.radius);
      const int i = block.first_of(place);
      sums.store_to(
          sums.light, i,
          send_rays<kOrthographic>(job, p, choice(job, member_at(scene, place), k, set_of_rays),
                                   block.places(place), walk));
      if (k == 0) sums.store_to(sums.arrived, i, set(glm::vec3(0)));
    });
    walk.run();
    for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
      const int i = block.first_of(place);
      const M arrives = walk.blocked_px(block.places(place)) < set(0);
      const V3 light = if_then_else_zero(arrives, sums.load_from(sums.light, i));
      sums.store_to(sums.arrived, i,
                    mul_add(light, set(1 / float(job.rays)), sums.load_from(sums.arrived, i)));
    });
  }
}

template <bool kOrthographic>
void emitted(const EmittedJob& job, const Window& part) {
  const MarchScene& scene = job.march.scene;
  WalkOverFrame<kOrthographic> walk(job.march, job.bounds, EmittedBlock::kPixels);
  EmittedSums sums;
  for_each_emitted_block(scene, part, [&](const EmittedBlock& block) HWY_ATTR {
    // Twice where the error is wanted, which is what other points and rays change.
    for (int set_of_rays = 0; set_of_rays < (job.error ? 2 : 1); ++set_of_rays) {
      find_arriving<kOrthographic>(job, block, set_of_rays, walk, sums);
      // Halves of the slices differ by the square root of 3 times the error, two sets by that of 2.
      const V sign = set(std::sqrt(1.5f) * (set_of_rays == 0 ? 1 : -1));
      for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
        const std::ptrdiff_t i = place.index;
        const V3 light = sums.load_from(sums.arrived, block.first_of(place));
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
