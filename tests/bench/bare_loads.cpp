// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/bare_loads.cpp"
#include "bench/bare_loads.h"

#include <hwy/foreach_target.h>

#include "estimators/bitmask/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

float bare_loads_of_pixels(const March& march, int y0, int y1) {
  const D d;
  const MarchScene& scene = march.scene;
  V sum = hn::Zero(d);
  const Window rows{0, y0, scene.layout.width(), y1};
  for_each_vector(scene, rows, [&](const Place& place) HWY_ATTR {
    const int row = (place.y + scene.first_y) & (Interleaving::kPeriod - 1);
    for (const Slice& slice : march.pattern.member(place.column_phase, row)) {
      for (const SliceSide& side : slice.sides) {
        for (const SliceStep& step : side.steps) {
          const int q_row = place.y + step.row, first = place.column + step.column_shift;
          if (q_row < 0 || q_row >= scene.layout.height() || first >= scene.layout.columns() ||
              first + int(hn::Lanes(d)) <= 0)
            break;
          const std::ptrdiff_t i = place.index + step.offset;
          for (const MarchLayer& layer : scene.layers)
            sum = sum + hn::LoadU(d, layer.depth.data() + i);
        }
      }
    }
  });
  return hn::GetLane(hn::SumOfLanes(d, sum));
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {
HWY_EXPORT(bare_loads_of_pixels);
}
namespace ssdo::bench {
float bare_loads(const March& march, int y0, int y1) {
  return HWY_DYNAMIC_DISPATCH(bare_loads_of_pixels)(march, y0, y1);
}
}  // namespace ssdo::bench
#endif
