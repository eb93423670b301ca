// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>

#include "math/plane.h"
#include "parallel/tiles.h"
#include "simd/interleaved.h"

namespace ssdo {

/// Calls `work(part)` for bands of a part of a raster.
template <class Work>
void for_each_band_of(const Window& part, const Work& work, const Progress& progress) {
  for_each_band(
      part.height(),
      [&](int y0, int y1) {
        work(Window{part.x0, part.y0 + y0, part.x1, part.y0 + y1});
      },
      progress);
}

/// The same for parts as wide as a vector and taller than bands: rays of pixels above each other
/// visit the same cells, which are to stay in the cache.
template <class Work>
void for_each_tall_part_of(const Interleaving& layout, const Window& part, const Work& work,
                           const Progress& progress) {
  constexpr int kWidth = kMostLanes * Interleaving::kPeriod, kHeight = 64;
  const int first = ((part.x0 + layout.phase()) & -kWidth) - layout.phase(),
            columns = (part.x1 - first + kWidth - 1) / kWidth,
            rows = (part.height() + kHeight - 1) / kHeight;
  for_each_task(
      std::size_t(columns) * std::size_t(rows),
      [&](std::size_t i) {
        const int x = first + int(i) % columns * kWidth, y = part.y0 + int(i) / columns * kHeight;
        work(Window{std::max(x, part.x0), y, std::min(x + kWidth, part.x1),
                    std::min(y + kHeight, part.y1)});
      },
      progress);
}

/// A part of a raster with so many pixels around it.
inline Window grown(const Interleaving& layout, const Window& part, int by) {
  return {std::max(part.x0 - by, 0), std::max(part.y0 - by, 0),
          std::min(part.x1 + by, layout.width()), std::min(part.y1 + by, layout.height())};
}

}  // namespace ssdo
