// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "estimators/products.h"
#include "math/plane.h"
#include "parallel/tiles.h"
#include "scene/surfaces.h"

namespace ssdo {

/// A plane of the guide's size as filters take and give it.
struct FilterPlane {
  std::variant<Plane<float>, Plane<glm::vec3>> plane;
  Filtering filtering;

  int components() const { return plane.index() == 0 ? 1 : 3; }

  /// The components of one pixel after the other.
  const float* values() const {
    static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
    return std::visit([](const auto& p) { return reinterpret_cast<const float*>(p.pixels.data()); },
                      plane);
  }
  float* values() { return const_cast<float*>(std::as_const(*this).values()); }
};
using FilterPlanes = std::vector<FilterPlane>;

/// Planes of the same sizes and kinds, whose values are whatever was in memory.
inline FilterPlanes like(const FilterPlanes& other) {
  FilterPlanes planes;
  for (const FilterPlane& from : other) {
    const auto plane_like = [&](const auto& plane) {
      return FilterPlane{std::decay_t<decltype(plane)>::like(plane), from.filtering};
    };
    planes.push_back(std::visit(plane_like, from.plane));
  }
  return planes;
}

/// A neighbour in a filter's window: its offset in pixels and its weight there.
struct Tap {
  int dx, dy;
  float weight;
};

/// `taps` turned from a row into a column.
inline std::vector<Tap> transposed(std::vector<Tap> taps) {
  for (Tap& tap : taps) tap = {tap.dy, tap.dx, tap.weight};
  return taps;
}

/// Averages one tile of `from` in the window of `taps`.
using TilePass = void (*)(const FilterPlanes& from, const Surfaces& guide,
                          const std::vector<Tap>& taps, const Tile& tile, FilterPlanes& to);

/// Runs `pass` from `noisy` with each window in turn, each on what the one before has left.
inline FilterPlanes in_passes(FilterPlanes noisy, const Surfaces& guide,
                              const std::vector<std::vector<Tap>>& windows, TilePass pass) {
  FilterPlanes to = like(noisy);
  for (const std::vector<Tap>& taps : windows) {
    for_each_tile(guide.width, guide.height,
                  [&](const Tile& tile) { pass(noisy, guide, taps, tile, to); });
    std::swap(noisy, to);
  }
  return noisy;
}

}  // namespace ssdo
