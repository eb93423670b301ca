// SPDX-License-Identifier: Apache-2.0
#include "estimators/view_space/depth_mips.h"

#include <algorithm>

#include "parallel/tiles.h"

namespace ssdo {
namespace {

int round_up(int value, int unit) { return (value + unit - 1) / unit * unit; }

}  // namespace

DepthMips::DepthMips(const ViewPlanes& planes)
    : left_(planes.first_column & (kPeriod - 1)),
      top_(planes.first_row & (kPeriod - 1)),
      rows_(round_up(planes.height() + top_, kPeriod)),
      // An odd number of cache lines, as in PaddedLayout.
      stride_((round_up(planes.width() + left_, 16) / 16 | 1) * 16),
      values_(
          std::make_unique_for_overwrite<float[]>(2 * std::size_t(rows_) * std::size_t(stride_))) {
  const int right = left_ + planes.width() - 1, bottom = top_ + planes.height() - 1;
  for_each_row(planes.height(), [&](int y) {
    std::copy_n(planes.z.row(y), planes.width(), row(0, y + top_) + left_);
  });
  for (int level = 1; level <= kCoarsest; ++level) {
    const int below = level - 1, first = top_ >> level;
    for_each_row((bottom >> level) - first + 1, [&](int i) {
      const int y = first + i;
      float* to = row(level, y);
      for (int x = left_ >> level; x <= right >> level; ++x) {
        const int from_x = std::clamp(2 * x + (y & 1), left_ >> below, right >> below),
                  from_y = std::clamp(2 * y + (x & 1), top_ >> below, bottom >> below);
        to[x] = row(below, from_y)[from_x];
      }
    });
  }
}

}  // namespace ssdo
