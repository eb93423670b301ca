// SPDX-License-Identifier: Apache-2.0
#include "math/pixel_grid.h"

#include "math/whole_division.h"

namespace ssdo {

Window PixelGrid::rows_of(const Window& window) const {
  const int from = std::clamp(y0, window.y0, window.y1);
  return {window.x0, from, window.x1, std::clamp(y1, from, window.y1)};
}

Window PixelGrid::of(const Window& window) const {
  const Window rows = rows_of(window);
  const auto first = [&](int pixel, int origin) {
    return ceil_divide(pixel - origin - stride / 2, stride);
  };
  return {first(rows.x0, origin_x), first(rows.y0, origin_y), first(rows.x1, origin_x),
          first(rows.y1, origin_y)};
}

}  // namespace ssdo
