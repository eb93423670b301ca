// SPDX-License-Identifier: Apache-2.0
//
// Planes that are written by all threads: the first touch of a page of memory costs more than its
// pixels do.
#pragma once

#include <algorithm>
#include <cstddef>
#include <glm/vec3.hpp>

#include "math/half_color.h"
#include "math/plane.h"
#include "parallel/tiles.h"

namespace ssdo {

/// A plane of one value.
template <class T>
Plane<T> filled(int width, int height, const T& value) {
  auto plane = Plane<T>::unset(width, height);
  for_each_row(height, [&](int y) {
    std::fill_n(plane.pixels.data() + plane.index(0, y), std::size_t(width), value);
  });
  return plane;
}

/// Colours in 16 bits a channel.
inline Plane<HalfColor> in_half(const Plane<glm::vec3>& colors) {
  auto half = Plane<HalfColor>::like(colors);
  for_each_row(colors.height, [&](int y) {
    const auto from = colors.pixels.begin() + std::ptrdiff_t(colors.index(0, y));
    std::copy_n(from, colors.width, half.pixels.begin() + std::ptrdiff_t(half.index(0, y)));
  });
  return half;
}

}  // namespace ssdo
