// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

#include "estimators/view_space/view_planes.h"

namespace ssdo {

/// A pattern of 4 x 4 numbers that repeats over the display window, laid out so that a vector of
/// neighbouring pixels reads its numbers with one load.
class TiledNoise {
 public:
  static constexpr int kSize = 4;

  /// `values` row by row.
  explicit TiledNoise(const std::array<float, kSize * kSize>& values) {
    for (std::size_t y = 0; y < kSize; ++y) {
      for (std::size_t x = 0; x < rows_[y].size(); ++x) {
        rows_[y][x] = values[y * kSize + x % kSize];
      }
    }
  }

  /// The numbers from a pixel of the planes on, one for each lane.
  const float* at(const ViewPlanes& planes, int x, int y) const {
    const int column = (x + planes.first_column) & (kSize - 1);
    const int row = (y + planes.first_row) & (kSize - 1);
    return &rows_[std::size_t(row)][std::size_t(column)];
  }

 private:
  std::array<std::array<float, kSize + PaddedLayout::kPad>, kSize> rows_;
};

}  // namespace ssdo
