// SPDX-License-Identifier: Apache-2.0
#include "scene/light/sun_shape.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>

namespace ssdo {
namespace {

/// Sums before each edge of `values`, divided by the whole; evenly spaced where there is nothing.
template <class Values>
void accumulate(const Values& values, int count, float* sums) {
  double whole = 0;
  for (int i = 0; i < count; ++i) whole += double(values(i));
  double before = 0;
  for (int i = 0; i < count; ++i) {
    sums[i] = whole > 0 ? float(before / whole) : float(i) / float(count);
    before += double(values(i));
  }
  sums[count] = 1;
}

/// Where `u` lies among `count` + 1 edges, in cells.
float invert(const float* sums, int count, float u) {
  // The first cell that ends past u is never an empty one.
  const int cell = std::min(int(std::upper_bound(sums + 1, sums + count, u) - sums) - 1, count - 1);
  const float width = sums[cell + 1] - sums[cell];
  return float(cell) + (width > 0 ? std::clamp((u - sums[cell]) / width, 0.0f, 1.0f) : 0.5f);
}

}  // namespace

SunShape::SunShape(const Place& place, const Plane<float>& light)
    : place_(place), rows_(std::size_t(light.height) + 1), columns_(light.width + 1, light.height) {
  std::vector<double> in_row(std::size_t(light.height), 0.0);
  for (int y = 0; y < light.height; ++y) {
    for (int x = 0; x < light.width; ++x) in_row[std::size_t(y)] += double(light(x, y));
    accumulate([&](int x) { return light(x, y); }, light.width, &columns_(0, y));
  }
  accumulate([&](int y) { return in_row[std::size_t(y)]; }, light.height, rows_.data());
}

glm::vec3 SunShape::point(const glm::vec2& u) const {
  const int rows = columns_.height, columns = columns_.width - 1;
  const float down = invert(rows_.data(), rows, u.y);
  const int row = std::min(int(down), rows - 1);
  const float along = invert(&columns_(0, row), columns, u.x);
  // Equal steps of the height have equal solid angles.
  const float upper = std::cos(place_.polar + float(row) * place_.row_angle);
  const float lower = std::cos(place_.polar + float(row + 1) * place_.row_angle);
  const float height = glm::mix(upper, lower, down - float(row));
  const float across = std::sqrt(std::max(0.0f, 1 - height * height));
  const float azimuth = place_.azimuth + along * place_.column_angle;
  return place_.axes * glm::vec3(across * std::cos(azimuth), across * std::sin(azimuth), height);
}

}  // namespace ssdo
