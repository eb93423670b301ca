// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "estimators/bitmask/march_scene.h"
#include "math/uninitialized.h"

namespace ssdo {

/// Bounds of the depths of the solids of a layer, in square cells of pixels of several sizes: a ray
/// that passes in front of all solids of a cell, or behind them, need not look at its pixels.
///
/// Depths are given by a nearness that changes linearly along a straight line in the picture, of
/// points on a straight line in space: 1 / depth, or -depth where the camera is orthographic. So
/// planes have a linear nearness too, and the bound of the fronts is a plane: the bound of a floor
/// is the floor itself, and a ray that leaves the floor misses the whole cell, however flat it
/// runs.
class DepthBounds {
 public:
  /// Sides of cells are powers of two, from kSmallest to kLargest; their exponents.
  static constexpr int kSmallest = 2, kLargest = 8;

  /// The bounds of a layer of the scene.
  DepthBounds(const MarchScene& scene, const MarchLayer& layer);

  /// Pixel (0, 0) of the raster in the grid of cells. Cells lie in the display window alike
  /// whatever part of it the raster is.
  int first_x() const { return first_x_; }
  int first_y() const { return first_y_; }

  /// What is known of a cell, in memory.
  struct Stored {
    float nearest;  ///< of the fronts at the middle of the cell; minus infinity: nothing is there
    std::uint32_t slopes;  ///< of that bound per pixel: to the right as the upper half of a float,
                           ///< to the bottom in the lower 16 bits
    float farthest;        ///< of the backs; infinity: nothing is there
    float unused = 0;
  };

  /// Cells of kSmallest are at row * columns() + column, in the first rows() rows. Each larger size
  /// follows on the one before, with half as many rows.
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  const Stored* cells() const { return cells_.data(); }

  /// Nearness of front and back of the pixels of every cell of kSmallest, row by row, in the order
  /// of the cells: what a ray needs in a cell is side by side. Not-a-number where there is nothing.
  const glm::vec2* pixels() const { return pixels_.data(); }

 private:
  struct Cell;

  Cell load(int size, int column, int row) const;
  void store(int size, int column, int row, const Cell& cell);
  std::size_t index(int size, int column, int row) const;
  void gather_pixels(const MarchScene& scene, const MarchLayer& layer, int row);
  void gather_cells(int size, int row);

  int first_x_, first_y_, columns_, rows_;
  std::vector<Stored, Uninitialized<Stored>> cells_;
  std::vector<glm::vec2, Uninitialized<glm::vec2>> pixels_;
};

/// The bounds of every layer of a scene.
std::vector<DepthBounds> depth_bounds(const MarchScene& scene);

}  // namespace ssdo
