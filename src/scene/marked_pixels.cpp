// SPDX-License-Identifier: Apache-2.0
#include "scene/marked_pixels.h"

#include <algorithm>
#include <numeric>

#include "parallel/tiles.h"

namespace ssdo {
namespace {

std::size_t count_in_row(const Plane<unsigned char>& mask, int y) {
  const auto row = mask.pixels.begin() + std::ptrdiff_t(mask.index(0, y));
  return std::size_t(mask.width) - std::size_t(std::count(row, row + mask.width, 0));
}

}  // namespace

std::size_t count_marked(const Plane<unsigned char>& mask) {
  return count_over_rows(mask.height, [&](int y) { return count_in_row(mask, y); });
}

std::vector<std::size_t> every_marked(const Plane<unsigned char>& mask, std::size_t stride) {
  std::vector<std::size_t> before(std::size_t(mask.height) + 1);  // marked above each row
  for_each_row(mask.height, [&](int y) { before[std::size_t(y) + 1] = count_in_row(mask, y); });
  std::partial_sum(before.begin(), before.end(), before.begin());
  std::vector<std::size_t> places((before.back() + stride - 1) / stride);
  for_each_row(mask.height, [&](int y) {
    std::size_t number = (before[std::size_t(y)] + stride - 1) / stride,
                to_skip = number * stride - before[std::size_t(y)];
    if (number * stride >= before[std::size_t(y) + 1]) return;
    for (std::size_t i = mask.index(0, y); i < mask.index(0, y + 1); ++i) {
      if (mask[i] == 0 || to_skip-- > 0) continue;
      places[number++] = i;
      to_skip = stride - 1;
    }
  });
  return places;
}

}  // namespace ssdo
