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
  const int half = stride / 2;
  return {ceil_divide(rows.x0 - half, stride), ceil_divide(rows.y0 - half, stride),
          ceil_divide(rows.x1 - half, stride), ceil_divide(rows.y1 - half, stride)};
}

}  // namespace ssdo
