// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "math/plane.h"
#include "scene/geometry.h"

namespace ssdo {

/// A step from a pixel to one of its neighbours.
struct Direction {
  int dx, dy;
};

/// Rows, columns and both diagonals.
inline constexpr std::array<Direction, 4> kDirections = {{{1, 0}, {0, 1}, {1, 1}, {-1, 1}}};

/// Set in the connections of a pixel that shows a surface.
inline constexpr unsigned char kShowsSurface = 1 << kDirections.size();

/// Which neighbours continue the surface of each pixel: bit k is set where it and the pixel that
/// lies kDirections[k] away are on one surface, by the rule of scene/same_surface.h.
Plane<unsigned char> find_connections(const Geometry& geometry);

}  // namespace ssdo
