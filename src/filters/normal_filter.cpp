// SPDX-License-Identifier: Apache-2.0
//
// The blur by normals that goes with hemisphere ambient occlusion in Unity: seven taps along rows
// and then along columns, each weighted by how alike its normal is to the pixel's.
//
//   out(p) = sum_i g(|i|) w(p, q) in(q) / sum_i g(|i|) w(p, q),  q = p + i along the row or column
//   g = 0.37004405286, 0.31718061674, 0.19823788546, 0.11453744493 for |i| = 0 .. 3
//   w = smoothstep(0.8, 1, N_p . N_q)
//
// The source prints g but not how it compares normals; w is the usual smooth step between the
// cosine from which other filters of the kind reject and that of equal normals. What differs: the
// source scales the spacing of the taps, which is one pixel here, by a setting. Depth does not
// count, so that a far wall bleeds into a near one that faces the same way: a fault that is kept.
#include "filters/normal_filter.h"

#include <array>
#include <cstdlib>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filters/normal_filter.cpp"
#include <hwy/foreach_target.h>

#include "filters/window_average-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

struct NormalsAlike {
  HWY_INLINE V operator()(const Shown& p, const Shown& q) const {
    constexpr float kSlope = 1 / (1 - kLeastCosine);
    const V cosine = dot(p.normal, q.normal);
    return smooth(saturate(hn::MulAdd(cosine, set(kSlope), set(-kLeastCosine * kSlope))));
  }
};

void normal_tile(const FilterPlanes& noisy, const Surfaces& guide, const std::vector<Tap>& taps,
                 const Tile& tile, FilterPlanes& out) {
  WindowAverage<NormalsAlike>(noisy, guide, taps, {}, tile, out).run();
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(normal_tile);

FilterPlanes filter_normal(FilterPlanes noisy, const Surfaces& guide, int /*pattern_size*/) {
  constexpr std::array<double, 4> kWeights = {0.37004405286, 0.31718061674, 0.19823788546,
                                              0.11453744493};
  std::vector<Tap> row;
  for (int i = -3; i <= 3; ++i) row.push_back({i, 0, float(kWeights[std::size_t(std::abs(i))])});
  return in_passes(std::move(noisy), guide, {row, transposed(row)},
                   HWY_DYNAMIC_DISPATCH(normal_tile));
}

}  // namespace ssdo
#endif
