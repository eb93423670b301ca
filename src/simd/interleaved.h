// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>

#include "simd/width.h"

namespace ssdo {

/// Where the pixels of a picture lie when every row is stored as eight rows of every eighth pixel.
/// Pixels that are eight apart then are neighbours in memory, and the same offset from each of them
/// leads to neighbours again: a whole vector of pixels reads its samples with one load.
///
/// Rows are padded by kPad entries on both sides, so that a vector of which one lane lies in the
/// picture may be read whole. The length of a row is an odd number of cache lines: at a power of
/// two, pixels below each other would share a few places of the cache.
class Interleaving {
 public:
  static constexpr int kPeriod = 8;
  static constexpr int kShift = 3;  ///< x / kPeriod is x >> kShift
  static constexpr int kPad = kMostLanes;

  /// `phase` is the column of the display window that the first pixel has, modulo kPeriod.
  Interleaving(int width, int height, int phase)
      : width_(width),
        height_(height),
        phase_(phase),
        columns_((width + phase + kPeriod - 1) / kPeriod),
        stride_((((columns_ + kPad - 1) / kPad + 2) | 1) * kPad) {}

  int width() const { return width_; }
  int height() const { return height_; }
  int phase() const { return phase_; }
  int columns() const { return columns_; }  ///< entries of each of the eight rows
  std::ptrdiff_t stride() const { return stride_; }
  std::size_t size() const { return std::size_t(stride_) * std::size_t(height_) * kPeriod; }

  /// Index of entry `column` of the row that holds every eighth pixel of row `y` from
  /// `column_phase` on.
  std::ptrdiff_t index(int y, int column_phase, int column) const {
    return (std::ptrdiff_t(y) * kPeriod + column_phase) * stride_ + kPad + column;
  }
  /// Index of a pixel.
  std::ptrdiff_t index(int x, int y) const {
    const int shifted = x + phase_;
    return index(y, shifted & (kPeriod - 1), shifted >> kShift);
  }

 private:
  int width_, height_, phase_, columns_;
  std::ptrdiff_t stride_;
};

/// Values of a picture in that order, not initialised.
class InterleavedPlane {
 public:
  InterleavedPlane() = default;
  explicit InterleavedPlane(const Interleaving& layout)
      : values_(std::make_unique_for_overwrite<float[]>(layout.size())) {}

  float* data() { return values_.get(); }
  const float* data() const { return values_.get(); }
  float& operator[](std::ptrdiff_t i) { return values_[std::size_t(i)]; }
  float operator[](std::ptrdiff_t i) const { return values_[std::size_t(i)]; }

  /// Sets a whole row, with what is outside the picture.
  void fill_row(const Interleaving& layout, int y, float value) {
    float* first = data() + layout.index(y, 0, -Interleaving::kPad);
    std::fill(first, first + Interleaving::kPeriod * layout.stride(), value);
  }

 private:
  std::unique_ptr<float[]> values_;
};

/// Vectors or colours of a picture in that order, coordinate by coordinate.
using InterleavedVectors = std::array<InterleavedPlane, 3>;

}  // namespace ssdo
