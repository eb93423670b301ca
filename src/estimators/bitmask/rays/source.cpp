// SPDX-License-Identifier: Apache-2.0
//
// The light of a source, by rays from each pixel to points of the source: one ray per pixel with
// few slices (rays_to_source()). Compiled once for every instruction set.
//
// Every pixel has its own rays. If the rays of some pixels decide for their neighbours, thin
// shadows are missed: with the rays of one pixel in four, shadows two pixels wide were missing in a
// third of the frames of a slow pan, and a safe test of what lies between rays costs as much as the
// rays.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/bitmask/rays/source.cpp"
#include <hwy/foreach_target.h>

#include <algorithm>
#include <cmath>

#include "estimators/bitmask/rays/block-inl.h"
#include "estimators/bitmask/rays/ray-inl.h"
#include "estimators/bitmask/rays/unseen_side-inl.h"
#include "scene/light/light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

/// The target points of the rays of a vector of pixels, from the member `aside` places after its
/// own. Neighbouring lanes are in neighbouring blocks of the pattern.
HWY_INLINE V3 points_of(const MarchScene& scene, const PointsOfSource& points, const Place& place,
                        int aside) {
  const std::size_t member = std::size_t(member_at(scene, place) + aside) % points.front().size();
  const int row = ((place.y + scene.first_y) >> Interleaving::kShift) & 1,
            column = (place.column + (scene.first_x >> Interleaving::kShift)) & 1;
  const V3 even = set(points[std::size_t(2 * row + column)][member]),
           odd = set(points[std::size_t(2 * row + (column ^ 1))][member]);
  return {hn::OddEven(odd.x, even.x), hn::OddEven(odd.y, even.y), hn::OddEven(odd.z, even.z)};
}

/// The target points of the rays of a vector of pixels. Where such a point is below the horizon of
/// a lane, as part of a source may be, it is replaced by the point of another member.
HWY_INLINE SourcePoints points_above(const SourceJob& job, const PointsOfSource& points,
                                     const MarchReceiver& p) {
  constexpr int kTries = 8, kApart = 9;  // members that lie apart in both directions
  const auto at = [&](int k) HWY_ATTR {
    return seen(job.source, p.position, points_of(job.march.scene, points, p.place, kApart * k));
  };
  SourcePoints found = at(0);
  const SourceCones all = cones(job.source, p.position);
  const M sets = hn::Abs(dot(p.normal, all.to)) < all.sine;
  for (int k = 1; k < kTries; ++k) {
    const M below = hn::And(sets, dot(p.normal, found.to) <= set(0));
    if (!any(below)) break;
    const SourcePoints other = at(k);
    found = {if_then_else(below, other.to, found.to),
             hn::IfThenElse(below, other.distance, found.distance),
             hn::IfThenElse(below, other.weight, found.weight)};
  }
  return found;
}

/// The width in pixels of the penumbra of an occluder at this distance, where the source is
/// `source_distance` away: an occluder half way to the source throws a penumbra as wide as the
/// source.
template <bool kOrthographic>
HWY_INLINE V penumbra_px(const SourceJob& job, const MarchReceiver& p, V distance,
                         V source_distance) {
  const MarchScene& scene = job.march.scene;
  const V angle = set(2) * cones(job.source, p.position).angular_radius,
          left = hn::Max(set(1) - distance / source_distance, set(1e-3f));
  const V width = distance * (angle * set(std::max(scene.fx, scene.fy))) / left;
  const V px = kOrthographic ? width : width / (set(0) - p.position.z);
  return hn::Clamp(px, set(1), set(float(4 * Interleaving::kPeriod)));
}

HWY_INLINE OffscreenVisibilityLanes pass_of(const SourceJob& job, const Place& place) {
  const V least = set(job.offscreen.unblocked);
  if (!job.unblocked) return {least, job.offscreen.blocked};
  return {hn::MulAdd(load(*job.unblocked, place.index), set(1) - least, least),
          job.offscreen.blocked};
}

/// What the rays of the pixels of a block have found, by Block::first_of().
struct BlockSums {
  alignas(64) float weight[Block::kPixels];    ///< the light of the rays
  alignas(64) float share[Block::kPixels];     ///< the light of the rays that arrive
  alignas(64) float width_px[Block::kPixels];  ///< of penumbras, weighted by the blocked light

  HWY_INLINE void clear(int i) {
    for (float* sum : {weight, share, width_px}) store(set(0), sum + i);
  }
  HWY_INLINE void add(int i, V light, V arrives, V penumbra_px) {
    const V lost = light * (set(1) - arrives);
    store(load(weight + i) + light, weight + i);
    store(hn::MulAdd(light, arrives, load(share + i)), share + i);
    store(hn::MulAdd(lost, penumbra_px, load(width_px + i)), width_px + i);
  }
};

/// Rays of a block to the points that the members of the pattern look at.
struct SourceRays {
  BlockVectors to;
  BlockValues length;
  BlockValues light;  ///< that of the point: its weight times the cosine to the normal; 0: no ray
};

template <bool kOrthographic>
HWY_INLINE Ray ray_of(const MarchScene& scene, const MarchReceiver& p, const SourceRays& rays,
                      int i) {
  return make_ray<kOrthographic>(scene, p, rays.to(i), rays.length(i), rays.light(i) > set(0));
}

/// The points whose light is computed: those that the pixels show or, with `unseen_of`, the points
/// on their unseen sides.
HWY_INLINE MarchReceiver lit_point(const SourceJob& job, const MarchReceiver& shown) {
  MarchReceiver p = shown;
  if (!job.unseen_of) return p;
  const UnseenSide side = unseen_side(*job.unseen_of, p);
  p.position = side.position, p.normal = side.normal;
  p.valid = hn::And(p.valid, side.ends);
  return p;
}

/// The starts of rays from these points in the direction `to`: on unseen sides, past their own
/// solids.
HWY_INLINE MarchReceiver start_of_ray(const SourceJob& job, const MarchReceiver& shown,
                                      const V3& to) {
  const MarchScene& scene = job.march.scene;
  MarchReceiver p = shown;
  if (job.unseen_of) {
    const UnseenSide side = unseen_side(*job.unseen_of, p);
    p = moved_to(scene, p, mul_add(to, side.clear, side.position), to);
  }
  p.reach_px = reach_px(scene, p, job.march.radius);
  return p;
}

HWY_INLINE V way_in_solid(const SourceJob& job, const MarchReceiver& shown) {
  return job.unseen_of ? unseen_side(*job.unseen_of, shown).clear : set(0);
}

template <bool kOrthographic>
void source(const SourceJob& job, const Window& part) {
  const MarchScene& scene = job.march.scene;
  Occluders<kOrthographic> occluders(job.march, job.bounds);
  BlockSums sums;
  SourceRays rays{};
  for_each_block(scene, part, [&](const Block& block) HWY_ATTR {
    for_each_vector(scene, block.part,
                    [&](const Place& place) HWY_ATTR { sums.clear(block.first_of(place)); });
    for (const PointsOfSource& points : job.points) {
      occluders.clear();
      for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
        const MarchReceiver shown = load_receiver(scene, place), lit = lit_point(job, shown);
        const int i = block.first_of(place);
        const SourcePoints to = points_above(job, points, lit);
        const V light = to.weight * dot(lit.normal, to.to);
        const M is_lit = hn::And(lit.valid, light > set(0));
        rays.light.set_at(i, hn::IfThenElseZero(is_lit, light));
        if (!any(is_lit)) return;
        rays.to.set_at(i, to.to);
        rays.length.set_at(i, hn::Max(to.distance - way_in_solid(job, shown), set(0)));
        const MarchReceiver p = start_of_ray(job, shown, to.to);
        occluders.ask(i, p, ray_of<kOrthographic>(scene, p, rays, i));
      });
      occluders.run(job.together);
      for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
        const int i = block.first_of(place);
        if (!any(rays.light(i) > set(0))) return;
        const MarchReceiver p = start_of_ray(job, load_receiver(scene, place), rays.to(i));
        const Ray ray = ray_of<kOrthographic>(scene, p, rays, i);
        const RayVisibility a = occluders.visibility(i, p, ray, pass_of(job, place));
        sums.add(i, rays.light(i), a.share,
                 penumbra_px<kOrthographic>(job, p, a.blocked_at, ray.length));
      });
    }
    for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
      const std::ptrdiff_t i = place.index;
      const int from = block.first_of(place);
      const V zero = set(0), weight = load(sums.weight + from), arrives = load(sums.share + from),
              blocked = weight - arrives,
              widths = load(sums.width_px + from) * set(1 / kPenumbraUnit);
      const V share = hn::IfThenElseZero(weight > zero, arrives / weight);
      if (job.unseen_of) return store(share, job.found->unseen, i);
      store(share, job.found->share, i);
      store(weight / set(float(job.points.size())), job.found->weight, i);
      store(hn::IfThenElseZero(blocked > zero, widths / blocked), job.found->width, i);
    });
  });
}

void source_of_pixels(const SourceJob& job, const Window& part) {
  job.march.scene.orthographic ? source<true>(job, part) : source<false>(job, part);
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(source_of_pixels);

void march_source(const SourceJob& job, const Window& part) {
  HWY_DYNAMIC_DISPATCH(source_of_pixels)(job, part);
}

}  // namespace ssdo
#endif
