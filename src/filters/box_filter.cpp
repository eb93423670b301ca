// SPDX-License-Identifier: Apache-2.0
//
// The box blur that usually ends screen-space ambient occlusion: the plain mean of as many pixels
// as the tiled noise has, here T x T, so that each member of the pattern counts once.
//
//   out(p) = mean of in(p + (i, j)),  i, j = -T/2 .. T/2 - 1
//
// An even window has no centre: for T = 4 the offsets are -2 .. +1, and the picture moves by half a
// pixel. The mean knows no edges and bleeds across them. Both are kept, as users of the original
// expect its look. What differs: pixels that show no surface, and what lies outside the picture,
// are left out of the mean, where a texture would give its border.
#include "filters/box_filter.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filters/box_filter.cpp"
#include <hwy/foreach_target.h>

#include "filters/window_average-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

struct BothSurfaces {
  HWY_INLINE V operator()(const Shown& p, const Shown& q) const {
    const M exist = dot(p.normal, p.normal) * dot(q.normal, q.normal) > set(0);
    return hn::IfThenElseZero(exist, set(1));
  }
};

void box_tile(const FilterPlanes& noisy, const Surfaces& guide, const std::vector<Tap>& taps,
              const Tile& tile, FilterPlanes& out) {
  WindowAverage<BothSurfaces>(noisy, guide, taps, {}, tile, out).run();
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(box_tile);

FilterPlanes filter_box(FilterPlanes noisy, const Surfaces& guide, int pattern_size) {
  std::vector<Tap> window;
  const int first = -(pattern_size / 2);
  for (int dy = first; dy < first + pattern_size; ++dy) {
    for (int dx = first; dx < first + pattern_size; ++dx) window.push_back({dx, dy, 1});
  }
  return in_passes(std::move(noisy), guide, {window}, HWY_DYNAMIC_DISPATCH(box_tile));
}

}  // namespace ssdo
#endif
