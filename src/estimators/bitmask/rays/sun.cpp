// SPDX-License-Identifier: Apache-2.0
//
// The light of a sun, by rays from each pixel to points of it: one at few slices. Compiled once for
// every instruction set.
//
// All pixels have rays of their own. Where those of some of them decide for their neighbours, thin
// shadows are missed: with one in four, those of two pixels were not there in a third of the frames
// of a slow pan, and a test that is sure of what lies between them costs as much as the rays.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/bitmask/rays/sun.cpp"
#include <hwy/foreach_target.h>

#include <algorithm>
#include <cmath>

#include "estimators/bitmask/rays/ray-inl.h"
#include "scene/light/light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// Directions to points of a sun, and their cosines to the normals.
struct SunPoints {
  V3 to;
  V cosine;
};

/// The points that the rays of a vector of pixels go to, `aside` members away from its own. Lanes
/// are in blocks beside each other.
HWY_INLINE V3 points_of(const MarchScene& scene, const RayDirections& directions,
                        const Place& place, int aside) {
  const std::size_t member =
      std::size_t(member_at(scene, place) + aside) % directions.front().size();
  const int row = ((place.y + scene.first_y) >> Interleaving::kShift) & 1,
            column = (place.column + (scene.first_x >> Interleaving::kShift)) & 1;
  const V3 even = set(directions[std::size_t(2 * row + column)][member]),
           odd = set(directions[std::size_t(2 * row + (column ^ 1))][member]);
  return {hn::OddEven(odd.x, even.x), hn::OddEven(odd.y, even.y), hn::OddEven(odd.z, even.z)};
}

/// The points that the rays of a vector of pixels go to. Where that is below the horizon of a lane,
/// as part of a sun may be, another one.
HWY_INLINE SunPoints points_above(const SunJob& job, const RayDirections& directions,
                                  const Place& place, const V3& normal) {
  constexpr int kTries = 8, kApart = 9;  // members that lie apart in both directions
  const auto at = [&](int k) HWY_ATTR {
    const V3 to = points_of(job.march.scene, directions, place, kApart * k);
    return SunPoints{to, dot(normal, to)};
  };
  SunPoints found = at(0);
  const V middle = dot(normal, set(job.sun->direction));
  const M sets = hn::Abs(middle) < set(std::sin(job.sun->angular_radius));
  for (int k = 1; k < kTries; ++k) {
    const M below = hn::And(sets, found.cosine <= set(0));
    if (!any(below)) break;
    const SunPoints other = at(k);
    found = {if_then_else(below, other.to, found.to),
             hn::IfThenElse(below, other.cosine, found.cosine)};
  }
  return found;
}

/// Width in pixels of the penumbra that something throws at this distance.
template <bool kOrthographic>
HWY_INLINE V penumbra_px(const SunJob& job, const MarchReceiver& p, V distance) {
  const MarchScene& scene = job.march.scene;
  const V width = distance * set(2 * job.sun->angular_radius * std::max(scene.fx, scene.fy));
  const V px = kOrthographic ? width : width / (set(0) - p.position.z);
  return hn::Clamp(px, set(1), set(float(4 * Interleaving::kPeriod)));
}

/// Pixels whose rays are on their way together: a vector wide and kRows high, or what of that is in
/// a part of the raster.
struct Block {
  static constexpr int kRows = 4, kWidth = Interleaving::kPeriod * kLanes, kPixels = kRows * kWidth;

  Window part;

  /// The first of the numbers that the pixels of a vector have in their order in memory.
  HWY_INLINE int first_of(const Place& at) const {
    return ((at.y - part.y0) * Interleaving::kPeriod + at.column_phase) * kLanes;
  }

  /// Numbers for the pixels of a vector; those of squares of kRows x kRows follow on each other.
  HWY_INLINE VI places(const Place& at) const {
    const int in_lane = at.column_phase / kRows * kRows * kRows + (at.y - part.y0) * kRows +
                        at.column_phase % kRows;
    return hn::Iota(DI(), 0) * set_int(kPixels / kLanes) + set_int(in_lane);
  }
};

/// What the rays of the pixels of a block have found, by Block::first_of().
struct BlockSums {
  alignas(64) float weight[Block::kPixels];    ///< the cosines of the rays
  alignas(64) float share[Block::kPixels];     ///< those of the rays that arrive
  alignas(64) float width_px[Block::kPixels];  ///< of penumbras, by the cosines of the others

  HWY_INLINE void clear(int i) {
    for (float* sum : {weight, share, width_px}) store(set(0), sum + i);
  }
  HWY_INLINE void add(int i, V cosine, V arrives, V penumbra_px) {
    const V lost = cosine * (set(1) - arrives);
    store(load(weight + i) + cosine, weight + i);
    store(hn::MulAdd(cosine, arrives, load(share + i)), share + i);
    store(hn::MulAdd(lost, penumbra_px, load(width_px + i)), width_px + i);
  }
};

/// Calls `work(block)` for the blocks of a part of the raster.
template <class Work>
HWY_INLINE void for_each_block(const MarchScene& scene, const Window& part, const Work& work) {
  const int phase = scene.layout.phase(), first = ((part.x0 + phase) & -Block::kWidth) - phase;
  for (int y = part.y0; y < part.y1; y += Block::kRows) {
    for (int x = first; x < part.x1; x += Block::kWidth) {
      work(Block{{std::max(x, part.x0), y, std::min(x + Block::kWidth, part.x1),
                  std::min(y + Block::kRows, part.y1)}});
    }
  }
}

/// Rays from a vector of receivers to the points that their member of the pattern looks at.
struct SunRays {
  MarchReceiver p;
  V cosine;  ///< to the normal; 0 where there is no ray
  Ray ray;
};

HWY_INLINE SunRays sun_rays(const SunJob& job, const RayDirections& directions,
                            const Place& place) {
  const MarchScene& scene = job.march.scene;
  SunRays rays{load_receiver(scene, place), {}, {}};
  MarchReceiver& p = rays.p;
  p.reach_px = reach_px(scene, p, job.march.radius);
  const SunPoints points = points_above(job, directions, place, p.normal);
  const M above = hn::And(p.valid, points.cosine > set(0));
  rays.cosine = hn::IfThenElseZero(above, points.cosine);
  rays.ray = make_ray(scene, p, points.to, above);
  return rays;
}

template <bool kOrthographic>
void sun(const SunJob& job, const Window& part) {
  const MarchScene& scene = job.march.scene;
  WalkOverFrame<kOrthographic> walk(job.march, job.bounds, Block::kPixels);
  BlockSums sums;
  for_each_block(scene, part, [&](const Block& block) HWY_ATTR {
    for_each_vector(scene, block.part,
                    [&](const Place& place) HWY_ATTR { sums.clear(block.first_of(place)); });
    for (const RayDirections& directions : job.directions) {
      walk.clear();
      for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
        const SunRays rays = sun_rays(job, directions, place);
        walk.put(block.places(place), rays.p, rays.ray, rays.ray.open);
      });
      walk.run();
      for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
        const auto [p, cosine, ray] = sun_rays(job, directions, place);
        const Arrival a =
            arrival<kOrthographic>(job.march, p, ray, walk.blocked_px(block.places(place)),
                                   turn_of_member(member_at(scene, place)), job.pass);
        sums.add(block.first_of(place), cosine, a.share,
                 penumbra_px<kOrthographic>(job, p, a.blocked_at));
      });
    }
    for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
      const std::ptrdiff_t i = place.index;
      const int from = block.first_of(place);
      const V zero = set(0), weight = load(sums.weight + from), arrives = load(sums.share + from),
              blocked = weight - arrives,
              widths = load(sums.width_px + from) * set(1 / kPenumbraUnit);
      store(hn::IfThenElseZero(weight > zero, arrives / weight), job.found->share, i);
      store(weight / set(float(job.directions.size())), job.found->weight, i);
      store(hn::IfThenElseZero(blocked > zero, widths / blocked), job.found->width, i);
    });
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
