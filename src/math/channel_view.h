// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "math/plane.h"

namespace ssdo {

/// One number of each pixel of a plane that somebody else owns: row by row, `step` floats apart
/// from `first` on.
struct ChannelView {
  const float* first = nullptr;
  int width = 0, height = 0;
  int step = 1;

  ChannelView() = default;
  ChannelView(const Plane<float>* plane) : ChannelView(*plane, 0) {}

  /// Component `c` of a plane of floats, or of vectors of them.
  template <class T>
  ChannelView(const Plane<T>& plane, int c)
      : first(reinterpret_cast<const float*>(plane.pixels.data()) + c),
        width(plane.width),
        height(plane.height),
        step(sizeof(T) / sizeof(float)) {}

  /// The value of a pixel, by its index in the plane.
  float operator[](std::size_t pixel) const { return first[pixel * std::size_t(step)]; }

  const float* at(int x, int y) const { return first + (std::ptrdiff_t(y) * width + x) * step; }
};

}  // namespace ssdo
