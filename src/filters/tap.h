// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "estimators/estimator.h"
#include "parallel/tiles.h"
#include "scene/geometry.h"

namespace ssdo {

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

/// Planes of the same sizes, whose values are whatever was in memory.
inline Products like(const Products& other) {
  const auto plane = [](const auto& p) { return std::decay_t<decltype(p)>::like(p); };
  return {plane(other.ao),   plane(other.direct),     plane(other.bounce),
          plane(other.bent), plane(other.reflection), plane(other.error)};
}

/// Runs `pass` from `noisy` with each window in turn, each on what the one before has left.
/// `pass(from, taps, tile, to)` averages one tile.
template <class Pass>
Products in_passes(Products noisy, const Geometry& geometry,
                   const std::vector<std::vector<Tap>>& windows, const Pass& pass) {
  Products from = std::move(noisy), to = like(from);
  for (const std::vector<Tap>& taps : windows) {
    for_each_tile(geometry.surfel.width, geometry.surfel.height,
                  [&](const Tile& tile) { pass(from, taps, tile, to); });
    std::swap(from, to);
  }
  return from;
}

}  // namespace ssdo
