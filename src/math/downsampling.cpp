// SPDX-License-Identifier: Apache-2.0
#include "math/downsampling.h"

#include "math/whole_division.h"

namespace ssdo {

Window Downsampling::small(const Window& large) const {
  const int x = floor_divide(display.x0, factor), y = floor_divide(display.y0, factor);
  return {x + floor_divide(large.x0 - display.x0, factor),
          y + floor_divide(large.y0 - display.y0, factor),
          x + ceil_divide(large.x1 - display.x0, factor),
          y + ceil_divide(large.y1 - display.y0, factor)};
}

Window Downsampling::large(const Window& small) const {
  const int x = floor_divide(display.x0, factor), y = floor_divide(display.y0, factor);
  return {display.x0 + (small.x0 - x) * factor, display.y0 + (small.y0 - y) * factor,
          display.x0 + (small.x1 - x) * factor, display.y0 + (small.y1 - y) * factor};
}

}  // namespace ssdo
