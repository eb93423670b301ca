// SPDX-License-Identifier: Apache-2.0
//
// The blur of M. McGuire, M. Mara, D. Luebke, "Scalable Ambient Obscurance", High Performance
// Graphics 2012, by the code published with the paper: nine taps, two pixels apart, along rows and
// then along columns, each weighted by how near it is in depth.
//
//   out(p) = sum_i g_|i| w(p, q) in(q) / sum_i g_|i| w(p, q)
//   q = p + 2 i along the row or column, i = -4 .. 4
//   g_0 = 0.15317,  g_1 .. g_4 = 0.3 + (0.144893, 0.122649, 0.092902, 0.06297)
//   w = max(0, 1 - |z_p - z_q| / 0.15)
//
// The 0.3 lifts all taps but the middle one, so that the window is nearly flat. The code compares
// depths as shares of a far plane at 300 units, with a slope of 2000: 0.15 is 300 / 2000, a length
// in scene units made for scenes of the size of rooms. What differs: the code stores these shares
// in 16 bits and clamps them at the far plane; it adds 0.0001 to the sum of weights, which darkens
// what has no neighbours.
#include "filters/depth_filter.h"

#include <array>
#include <cstdlib>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filters/depth_filter.cpp"
#include <hwy/foreach_target.h>

#include "filters/window_average-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

constexpr float kDepthReach = 300.0f / 2000;  ///< scene units

struct DepthsAlike {
  HWY_INLINE V operator()(const Shown& p, const Shown& q) const {
    const M exist = dot(p.normal, p.normal) * dot(q.normal, q.normal) > set(0);
    const V apart = hn::Abs(p.position.z - q.position.z);
    return hn::IfThenElseZero(exist, saturate(hn::NegMulAdd(apart, set(1 / kDepthReach), set(1))));
  }
};

void depth_tile(const FilterPlanes& noisy, const Surfaces& guide, const std::vector<Tap>& taps,
                const Tile& tile, FilterPlanes& out) {
  WindowAverage<DepthsAlike>(noisy, guide, taps, {}, tile, out).run();
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(depth_tile);

FilterPlanes filter_depth(FilterPlanes noisy, const Surfaces& guide, int /*pattern_size*/) {
  constexpr std::array<double, 5> kWeights = {0.15317, 0.444893, 0.422649, 0.392902, 0.36297};
  constexpr int kSpacing = 2;
  std::vector<Tap> row;
  for (int i = -4; i <= 4; ++i)
    row.push_back({kSpacing * i, 0, float(kWeights[std::size_t(std::abs(i))])});
  return in_passes(std::move(noisy), guide, {row, transposed(row)},
                   HWY_DYNAMIC_DISPATCH(depth_tile));
}

}  // namespace ssdo
#endif
