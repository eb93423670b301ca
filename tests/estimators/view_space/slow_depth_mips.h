// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "scene/geometry.h"

namespace ssdo::test {

/// Z_level(x, y) by the recursion of the paper; (x, y) counts from the display window's corner.
inline float slow_mip(const Geometry& g, int level, int x, int y) {
  const int x0 = g.window.x0 - g.display.x0, y0 = g.window.y0 - g.display.y0;
  const int side = 1 << level;
  const auto within = [&](int i, int first, int count) {
    const auto down = [&](int j) { return (j - ((j % side) + side) % side) / side; };
    return std::clamp(i, down(first), down(first + count - 1));
  };
  x = within(x, x0, g.window.width()), y = within(y, y0, g.window.height());
  if (level == 0) {
    const Surfel& s = g.surfaces(x - x0, y - y0);
    return s.is_surface() ? s.position.z : -INFINITY;
  }
  const auto odd = [](int i) { return i % 2 != 0 ? 1 : 0; };
  return slow_mip(g, level - 1, 2 * x + odd(y), 2 * y + odd(x));
}

}  // namespace ssdo::test
