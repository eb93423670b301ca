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
  Products products;
  for_each_plane([](const Product&, auto& to,
                    const auto& from) { to = std::decay_t<decltype(from)>::like(from); },
                 products, other);
  products.shares.are_ao = other.shares.are_ao;
  products.shares.suns.resize(other.shares.suns.size());
  products.shares.suns_again.resize(other.shares.suns_again.size());
  for_each_share([](auto& to, const auto& from) { to = std::decay_t<decltype(from)>::like(from); },
                 products, other);
  return products;
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
