// SPDX-License-Identifier: Apache-2.0
//
// Data windows that are smaller than the picture.
#pragma once

#include "math/plane.h"
#include "scene/geometry.h"

namespace ssdo::test {

/// The part of a plane that `window` cuts out, which counts from the plane's first pixel.
template <class T>
Plane<T> crop(const Plane<T>& from, const Window& window) {
  Plane<T> to(window.width(), window.height());
  for (int y = 0; y < to.height; ++y)
    for (int x = 0; x < to.width; ++x) to(x, y) = from(window.x0 + x, window.y0 + y);
  return to;
}

inline Surfaces crop(const Surfaces& from, const Window& window) {
  Surfaces to(window.width(), window.height());
  for (int y = 0; y < to.height; ++y)
    for (int x = 0; x < to.width; ++x) to.set(x, y, from(window.x0 + x, window.y0 + y));
  return to;
}

/// What `window`, a part of a geometry's window, shows of it.
inline Geometry crop(const Geometry& g, const Window& window) {
  Geometry part = g;
  part.window = window;
  const int left = g.window.x0, top = g.window.y0;
  part.surfaces =
      crop(g.surfaces, {window.x0 - left, window.y0 - top, window.x1 - left, window.y1 - top});
  return part;
}

}  // namespace ssdo::test
