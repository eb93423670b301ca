// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/rays/depth_bounds.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/vec2.hpp>
#include <limits>
#include <span>

#include "math/infinity.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

/// A margin larger than the rounding error of a nearness, relative to it.
constexpr float kRounding = 1e-6f;

/// The number cut off so that the upper half of a float holds it.
float shortened(float x) {
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(x) & 0xffff0000u);
}

}  // namespace

/// The bounds of a cell; a pixel is a cell too.
struct DepthBounds::Cell {
  float nearest = -kInfinity;
  glm::vec2 slope{0};
  float farthest = kInfinity;

  bool is_empty() const { return nearest == -kInfinity; }
};

namespace {

/// A cell among those that make up a larger one: `way` leads from the middle of the larger cell to
/// the middle of this one, and `half` from there to its outermost pixels.
template <class Cell>
struct Member {
  Cell cell;
  glm::vec2 way;
  float half;
};

/// The nearness, at the middle, of the lowest plane with this slope above all members.
template <class Cell>
float least_above(std::span<const Member<Cell>> members, const glm::vec2& slope) {
  float least = -kInfinity;
  for (const auto& m : members) {
    const glm::vec2 differs = glm::abs(m.cell.slope - slope);
    const float top = m.cell.nearest + m.half * (differs.x + differs.y) - glm::dot(slope, m.way);
    least = std::max(least, top + kRounding * std::abs(m.cell.nearest));
  }
  return least;
}

/// A cell that bounds all members, of which none is empty.
template <class Cell>
Cell joined(std::span<const Member<Cell>> members) {
  Cell out;
  if (members.empty()) return out;
  // The slope of the members' mean plane, by least squares; their ways are on a regular grid but
  // for empty ones.
  glm::vec2 mean_way(0);
  float mean = 0;
  const float share = 1 / float(members.size());
  for (const auto& m : members) mean_way += m.way * share, mean += m.cell.nearest * share;
  glm::vec2 products(0), squares(1e-20f);
  for (const auto& m : members) {
    const glm::vec2 way = m.way - mean_way;
    products += way * (m.cell.nearest - mean);
    squares += way * way;
    out.farthest = std::min(out.farthest, m.cell.farthest);
  }
  const glm::vec2 slope(shortened(products.x / squares.x), shortened(products.y / squares.y));
  out.nearest = least_above(members, glm::vec2(0));
  // Across an edge a level bound is often lower.
  if (const float tilted = least_above(members, slope); tilted < out.nearest)
    out.nearest = tilted, out.slope = slope;
  return out;
}

}  // namespace

DepthBounds::DepthBounds(const MarchScene& scene, const MarchLayer& layer) {
  constexpr int kSide = 1 << kLargest, kHalvings = kLargest - kSmallest;
  first_x_ = scene.first_x & (kSide - 1), first_y_ = scene.first_y & (kSide - 1);
  columns_ = ((first_x_ + scene.layout.width() - 1) >> kSmallest) + 1;
  rows_ = (((first_y_ + scene.layout.height() - 1) >> kLargest) + 1) << kHalvings;
  columns_ += columns_ & 1;
  cells_.resize(2 * std::size_t(rows_) * std::size_t(columns_));
  for_each_row(2 * rows_, [&](int row) {
    std::fill_n(&cells_[std::size_t(row) * std::size_t(columns_)], columns_,
                Stored{-kInfinity, 0, kInfinity});
  });
  const int used_rows = ((first_y_ + scene.layout.height() - 1) >> kSmallest) + 1;
  pixels_.resize(std::size_t(used_rows) * std::size_t(columns_) << (2 * kSmallest));
  for_each_row(used_rows, [&](int row) { gather_pixels(scene, layer, row); });
  for (int size = kSmallest + 1; size <= kLargest; ++size)
    for_each_row(rows_ >> (size - kSmallest), [&](int row) { gather_cells(size, row); });
}

std::size_t DepthBounds::index(int size, int column, int row) const {
  const int first_row = 2 * (rows_ - (rows_ >> (size - kSmallest)));
  return std::size_t(first_row + row) * std::size_t(columns_) + std::size_t(column);
}

DepthBounds::Cell DepthBounds::load(int size, int column, int row) const {
  const Stored& from = cells_[index(size, column, row)];
  return {
      from.nearest,
      {std::bit_cast<float>(from.slopes & 0xffff0000u), std::bit_cast<float>(from.slopes << 16)},
      from.farthest};
}

void DepthBounds::store(int size, int column, int row, const Cell& cell) {
  cells_[index(size, column, row)] = {
      cell.nearest,
      std::bit_cast<std::uint32_t>(cell.slope.x) | std::bit_cast<std::uint32_t>(cell.slope.y) >> 16,
      cell.farthest};
}

void DepthBounds::gather_pixels(const MarchScene& scene, const MarchLayer& layer, int row) {
  constexpr int kSide = 1 << kSmallest;
  const Interleaving& layout = scene.layout;
  const int y0 = std::max(0, row * kSide - first_y_),
            y1 = std::min(layout.height(), (row + 1) * kSide - first_y_);
  for (int column = 0; column < columns_; ++column) {
    const int left = column * kSide - first_x_, top = row * kSide - first_y_;
    std::array<Member<Cell>, std::size_t(kSide * kSide)> members;
    std::size_t count = 0;
    glm::vec2* const pixels = &pixels_[index(kSmallest, column, row) << (2 * kSmallest)];
    std::fill_n(pixels, kSide * kSide, glm::vec2(std::numeric_limits<float>::quiet_NaN()));
    for (int y = y0; y < y1; ++y) {
      for (int x = std::max(0, left); x < std::min(layout.width(), left + kSide); ++x) {
        const std::ptrdiff_t i = layout.index(x, y);
        const float front = layer.depth[i];
        if (!holds_solid(front)) continue;
        const float thickness = layer.thickness[i];
        Cell pixel;
        pixel.nearest = scene.orthographic ? -front : 1 / front;
        pixel.farthest = scene.orthographic ? -front - thickness : 1 / (front * (1 + thickness));
        pixels[(y - top) * kSide + x - left] = {pixel.nearest, pixel.farthest};
        pixel.farthest -= kRounding * std::abs(pixel.farthest);
        constexpr float kMiddle = 0.5f * (kSide - 1);
        members[count++] = {pixel, {float(x - left) - kMiddle, float(y - top) - kMiddle}, 0};
      }
    }
    store(kSmallest, column, row, joined<Cell>(std::span(members).first(count)));
  }
}

void DepthBounds::gather_cells(int size, int row) {
  const int columns = columns_ >> (size - kSmallest);
  const float quarter = float(1 << (size - 2)), half = float((1 << (size - 1)) - 1) / 2;
  for (int column = 0; column <= columns; ++column) {
    std::array<Member<Cell>, 4> members;
    std::size_t count = 0;
    for (int k = 0; k < 4; ++k) {
      const int x = 2 * column + k % 2, y = 2 * row + k / 2;
      if (x >= columns_) continue;
      const Cell cell = load(size - 1, x, y);
      if (cell.is_empty()) continue;
      members[count++] = {cell, {k % 2 ? quarter : -quarter, k / 2 ? quarter : -quarter}, half};
    }
    if (column < columns_) store(size, column, row, joined<Cell>(std::span(members).first(count)));
  }
}

std::vector<DepthBounds> depth_bounds(const MarchScene& scene) {
  std::vector<DepthBounds> of_layers;
  for (const MarchLayer& layer : scene.layers) of_layers.emplace_back(scene, layer);
  return of_layers;
}

}  // namespace ssdo
