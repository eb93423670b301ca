// SPDX-License-Identifier: Apache-2.0
//
// The light of a sun, by rays from each pixel to points of it: one at few slices. Then most rays
// would find what those around them find, so those of one pixel in four go first. Where all of them
// in 4 x 4 pixels and in the eight such squares around see the sun, or none does, so do or do not
// the others of the square. Compiled once for every instruction set.
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

/// Side of the squares of pixels that rays go for, in the display window.
constexpr int kSquare = 4;

/// By row of a square, the column of the pixel whose ray goes first: no two in a row, a column or a
/// diagonal, so that what throws a thin shadow is met.
constexpr int kGoesFirst[kSquare] = {1, 3, 0, 2};

HWY_INLINE int row_in_square(const MarchScene& scene, const Place& place) {
  return (place.y + scene.first_y) & (kSquare - 1);
}
HWY_INLINE bool goes_first(const MarchScene& scene, const Place& place) {
  return place.column_phase % kSquare == kGoesFirst[row_in_square(scene, place)];
}

/// Pixels whose rays are on their way together: a vector wide and kRows high, or what of that is in
/// a part of the raster. Of kSpacing pixels beside each other one has a ray.
template <int kSpacing>
struct Block {
  static constexpr int kRows = kSquare * kSpacing, kWidth = Interleaving::kPeriod * kLanes,
                       kPixels = kRows * kWidth / kSpacing;

  Window part;

  /// The first of the numbers that the pixels of a vector have in their order in memory.
  HWY_INLINE int first_of(const Place& at) const {
    return ((at.y - part.y0) * Interleaving::kPeriod + at.column_phase) * kLanes;
  }

  /// Numbers for the pixels of a vector; those of a square follow on each other.
  HWY_INLINE VI places(const Place& at) const {
    constexpr int kOfRow = kSquare / kSpacing;
    const int in_lane = at.column_phase / kSquare * kRows * kOfRow + (at.y - part.y0) * kOfRow +
                        at.column_phase % kSquare / kSpacing;
    return hn::Iota(DI(), 0) * set_int(kPixels / kLanes) + set_int(in_lane);
  }
};

/// What the rays of the pixels of a block have found, by Block::first_of().
struct BlockSums {
  using Block = ssdo::HWY_NAMESPACE::Block<1>;
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
template <class Block, class Work>
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

/// Calls `visit(blocked_px, own)` with SunJob::first in and around the squares of a vector of
/// pixels.
template <class Visit>
HWY_INLINE void for_each_first(const SunJob& job, const Place& place, const Visit& visit) {
  const MarchScene& scene = job.march.scene;
  const int top = place.y - row_in_square(scene, place), left = -(place.column_phase % kSquare);
  for (int row = -kSquare; row < 2 * kSquare; ++row) {
    const int y = top + row;
    if (y < 0 || y >= scene.layout.height()) continue;
    for (int column = -kSquare; column <= kSquare; column += kSquare) {
      const int dx = left + column + kGoesFirst[row & (kSquare - 1)];
      const std::ptrdiff_t i = place_beside(scene.layout, place, dx, row - (place.y - top)).index;
      visit(load(*job.first, i), column == 0 && row >= 0 && row < kSquare);
    }
  }
}

/// What the rays of a vector of pixels find, as Walk::blocked_px() gives it; not-a-number where
/// they have to look. Where all are blocked, the mean of those of the square.
HWY_INLINE V known_from_first(const SunJob& job, const Place& place) {
  const V unknown = hn::NaN(D()), zero = set(0), one = set(1);
  if (!job.first) return unknown;
  if (goes_first(job.march.scene, place)) return load(*job.first, place.index);
  V blocked = zero, seen = zero, own = zero, count = zero;
  for_each_first(job, place, [&](V px, bool is_own) HWY_ATTR {
    const V meets = hn::IfThenElseZero(px >= zero, one), sees = hn::IfThenElseZero(px < zero, one);
    blocked = blocked + meets, seen = seen + sees;
    if (!is_own) return;
    own = own + hn::IfThenElseZero(px >= zero, px);
    count = count + meets + sees;
  });
  const V value = hn::IfThenElse(seen > zero, set(-1), own / count);
  return hn::IfThenElse(hn::And(count > zero, hn::Min(blocked, seen) == zero), value, unknown);
}

template <bool kOrthographic>
void first_rays(const SunJob& job, const Window& part) {
  using First = Block<kSquare>;
  const MarchScene& scene = job.march.scene;
  WalkOverFrame<kOrthographic> walk(job.march, job.bounds, First::kPixels);
  for_each_block<First>(scene, part, [&](const First& block) HWY_ATTR {
    walk.clear();
    for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
      if (!goes_first(scene, place)) return;
      const SunRays rays = sun_rays(job, job.directions.front(), place);
      walk.put(block.places(place), rays.p, rays.ray, rays.ray.open, hn::NaN(D()));
    });
    walk.run();
    for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
      if (goes_first(scene, place))
        store(walk.blocked_px(block.places(place)), *job.first, place.index);
    });
  });
}

template <bool kOrthographic>
void sun(const SunJob& job, const Window& part) {
  using Block = ssdo::HWY_NAMESPACE::Block<1>;
  const MarchScene& scene = job.march.scene;
  WalkOverFrame<kOrthographic> walk(job.march, job.bounds, Block::kPixels);
  BlockSums sums;
  for_each_block<Block>(scene, part, [&](const Block& block) HWY_ATTR {
    for_each_vector(scene, block.part,
                    [&](const Place& place) HWY_ATTR { sums.clear(block.first_of(place)); });
    for (const RayDirections& directions : job.directions) {
      walk.clear();
      for_each_vector(scene, block.part, [&](const Place& place) HWY_ATTR {
        const V known = known_from_first(job, place);
        const M is_known = known == known;
        if (all(is_known)) return walk.put_known(block.places(place), known);
        const SunRays rays = sun_rays(job, directions, place);
        walk.put(block.places(place), rays.p, rays.ray, hn::AndNot(is_known, rays.ray.open), known);
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

void first_rays_of_pixels(const SunJob& job, const Window& part) {
  job.march.scene.orthographic ? first_rays<true>(job, part) : first_rays<false>(job, part);
}

void sun_of_pixels(const SunJob& job, const Window& part) {
  job.march.scene.orthographic ? sun<true>(job, part) : sun<false>(job, part);
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(first_rays_of_pixels);
HWY_EXPORT(sun_of_pixels);

void march_first_rays(const SunJob& job, const Window& part) {
  HWY_DYNAMIC_DISPATCH(first_rays_of_pixels)(job, part);
}

void march_sun(const SunJob& job, const Window& part) {
  HWY_DYNAMIC_DISPATCH(sun_of_pixels)(job, part);
}

}  // namespace ssdo
#endif
