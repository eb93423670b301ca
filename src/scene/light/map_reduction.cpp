// SPDX-License-Identifier: Apache-2.0
#include "scene/light/map_reduction.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/gtc/constants.hpp>

#include "parallel/tiles.h"

namespace ssdo {

glm::ivec2 MapReduction::size(int width, int height, int columns) {
  const int factor = std::max(1, width / columns);
  return {width / factor, factor == 1 ? height : std::max(1, height / factor)};
}

MapReduction::MapReduction(int width, int height, int columns) : width_(width), height_(height) {
  const glm::ivec2 reduced = size(width, height, columns);
  out_ = Plane<glm::vec3>(reduced.x, reduced.y);
  if (is_identity()) return;
  const std::int64_t from = width, to = out_.width;
  for (std::int64_t x = 0; x < from; ++x) {
    const std::int64_t column = x * to / from, left = (column + 1) * from - x * to;
    places_.push_back({int(column), std::min(1.0f, float(left) / float(to))});
  }
}

void MapReduction::add(int first, const Plane<glm::vec3>& rows) {
  if (is_identity()) {
    std::copy(rows.pixels.begin(), rows.pixels.end(), &out_(0, first));
    return;
  }
  const auto touched = [&](int y) { return int(std::int64_t(y) * out_.height / height_); };
  const int from = touched(first);
  const int end = std::min(out_.height, touched(first + rows.height - 1) + 2);
  for_each_row(end - from, [&](int i) {
    const int to = from + i;
    const auto top = int(std::int64_t(to) * height_ / out_.height),
               bottom = int((std::int64_t(to + 1) * height_ + out_.height - 1) / out_.height);
    for (int y = std::max(top, first); y < std::min(bottom, first + rows.height); ++y)
      add_row(y, &rows(0, y - first), to);
  });
}

/// Adds what of a row of the map lies in the row `to` of the result.
void MapReduction::add_row(int y, const glm::vec3* texels, int to) {
  // Between two heights, as many steradians as the cosines of their polar angles differ.
  const auto cosine = [](double height, int rows) {
    return std::cos(glm::pi<double>() * height / rows);
  };
  const double scale = double(height_) / out_.height;
  const double top = std::max(double(y), to * scale), bottom = std::min(y + 1.0, (to + 1) * scale);
  if (!(bottom > top)) return;
  const double share = (cosine(top, height_) - cosine(bottom, height_)) /
                       (cosine(to, out_.height) - cosine(to + 1, out_.height));
  const auto weight = float(share * out_.width / width_);
  glm::vec3* const out = &out_(0, to);
  for (int x = 0; x < width_; ++x) {
    const Place& place = places_[std::size_t(x)];
    const glm::vec3 light = weight * texels[x];
    out[place.column] += place.share * light;
    if (place.share < 1) out[place.column + 1] += (1 - place.share) * light;
  }
}

}  // namespace ssdo
