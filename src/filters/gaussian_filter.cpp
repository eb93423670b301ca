// SPDX-License-Identifier: Apache-2.0
//
// The edge-preserving blur of F. D. Luna, "Introduction to 3D Game Programming with DirectX 12",
// 2016, chapter 21: a Gaussian along rows and then along columns, which leaves out neighbours of
// another surface.
//
//   out(p) = sum_i g(i) w(p, q) in(q) / sum_i g(i) w(p, q),  q = p + i along the row or column
//   g(i) = exp(-i^2 / (2 s^2)),  i = -5 .. 5
//   w = 1 where N_p . N_q >= 0.8 and |z_p - z_q| <= 2, else 0
//
// s = 2.5, and both passes run three times, as in the code published with the book. The limit of
// depth is a length in scene units, made for the book's scene: in a scene of another size the
// depths reject too much or nothing. The book blurs at half width and half height what it has
// computed there, so that its window covers twice as many pixels of the picture. So does --filter
// source (plan/make_plan.cpp); --filter gaussian blurs the whole picture, a difference from the
// book.
#include "filters/gaussian_filter.h"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filters/gaussian_filter.cpp"
#include <hwy/foreach_target.h>

#include "filters/window_average-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

constexpr float kMostDepth = 2;  ///< scene units

struct SameSurface {
  HWY_INLINE V operator()(const Shown& p, const Shown& q) const {
    const M same = hn::And(dot(p.normal, q.normal) >= set(kLeastCosine),
                           hn::Abs(p.position.z - q.position.z) <= set(kMostDepth));
    return hn::IfThenElseZero(same, set(1));
  }
};

void gaussian_tile(const FilterPlanes& noisy, const Surfaces& guide, const std::vector<Tap>& taps,
                   const Tile& tile, FilterPlanes& out) {
  WindowAverage<SameSurface>(noisy, guide, taps, {}, tile, out).run();
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(gaussian_tile);

FilterPlanes filter_gaussian(FilterPlanes noisy, const Surfaces& guide, int /*pattern_size*/) {
  constexpr int kRadius = 5, kRounds = 3;
  constexpr double kSigma = 2.5;
  std::vector<Tap> row;
  for (int i = -kRadius; i <= kRadius; ++i)
    row.push_back({i, 0, float(std::exp(-i * i / (2 * kSigma * kSigma)))});
  std::vector<std::vector<Tap>> windows;
  for (int round = 0; round < kRounds; ++round)
    windows.insert(windows.end(), {row, transposed(row)});
  return in_passes(std::move(noisy), guide, windows, HWY_DYNAMIC_DISPATCH(gaussian_tile));
}

}  // namespace ssdo
#endif
