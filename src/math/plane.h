// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "math/uninitialized.h"

namespace ssdo {

/// A rectangle of whole pixels, x in [x0, x1) and y in [y0, y1), y pointing down, in the pixel
/// coordinates that the display window and the data window of an EXR share.
struct Window {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  std::size_t area() const { return std::size_t(width()) * std::size_t(height()); }
  bool contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
  bool operator==(const Window&) const = default;
};

/// The pixels that are in both windows. Area 0 at the origin: there are none.
inline Window intersection(const Window& a, const Window& b) {
  const Window both{std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1),
                    std::min(a.y1, b.y1)};
  return both.x0 < both.x1 && both.y0 < both.y1 ? both : Window{};
}

/// A row-major rectangle of values. (0, 0) is the upper left pixel of the window that the plane
/// was read from or is written to; the window itself is kept by whoever owns the plane.
template <class T>
struct Plane {
  int width = 0, height = 0;
  std::vector<T, Uninitialized<T>> pixels;

  Plane() = default;
  Plane(int w, int h, T value = T{})
      : width(w), height(h), pixels(std::size_t(w) * std::size_t(h), value) {}

  /// A plane whose values are whatever was in memory.
  static Plane unset(int width, int height) {
    Plane plane;
    plane.width = width, plane.height = height;
    plane.pixels.resize(std::size_t(width) * std::size_t(height));
    return plane;
  }

  /// The same, of the size of another plane.
  static Plane like(const auto& other) { return unset(other.width, other.height); }

  bool empty() const { return pixels.empty(); }
  std::size_t size() const { return pixels.size(); }
  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width) + x; }
  T& operator()(int x, int y) { return pixels[index(x, y)]; }
  const T& operator()(int x, int y) const { return pixels[index(x, y)]; }
  T& operator[](std::size_t i) { return pixels[i]; }
  const T& operator[](std::size_t i) const { return pixels[i]; }
};

}  // namespace ssdo
