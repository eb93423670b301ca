// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>

#include "math/fixed_ratio16.h"
#include "math/uninitialized.h"
#include "simd/width.h"

namespace ssdo {

/// Where the pixels of a picture lie when every row is stored as eight rows of every eighth pixel.
/// Pixels that are eight apart then are neighbours in memory, and the same offset from each of them
/// leads to neighbours again: a whole vector of pixels reads its samples with one load.
///
/// Before each row and after the last one there are kPad entries, so that a vector of which one
/// lane lies in the picture may be read whole. The length of a row is an odd number of cache lines:
/// at a power of two, pixels below each other would share a few places of the cache.
class Interleaving {
 public:
  static constexpr int kPeriod = 8;
  static constexpr int kShift = 3;                    ///< x / kPeriod is x >> kShift
  static constexpr int kMembers = kPeriod * kPeriod;  ///< pixels of a square of that side
  static constexpr int kPad = kMostLanes;

  /// `phase` is the column of the display window that the first pixel has, modulo kPeriod.
  Interleaving(int width, int height, int phase)
      : width_(width),
        height_(height),
        phase_(phase),
        columns_((width + phase + kPeriod - 1) / kPeriod),
        stride_((((columns_ + kPad - 1) / kPad + 1) | 1) * kPad) {}

  int width() const { return width_; }
  int height() const { return height_; }
  int phase() const { return phase_; }
  int columns() const { return columns_; }  ///< entries of each of the eight rows
  std::ptrdiff_t stride() const { return stride_; }
  std::size_t size() const { return std::size_t(stride_) * std::size_t(height_) * kPeriod + kPad; }

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

/// The same order for sparse pixels, one in every `spacing` x `spacing`: no two of them have both
/// the same row and the same column of the display window, each divided by `spacing`.
class SparseInterleaving {
 public:
  /// `spacing` divides Interleaving::kPeriod.
  SparseInterleaving(const Interleaving& all, int spacing)
      : spacing_(spacing), height_(all.height()), stride_(all.stride()) {}

  std::size_t size() const {
    return std::size_t((height_ + spacing_ - 1) / spacing_ * rows()) * std::size_t(stride_) +
           Interleaving::kPad;
  }

  /// The index here of the pixel that Interleaving::index() has for the same arguments.
  std::ptrdiff_t index(int y, int column_phase, int column) const {
    return (std::ptrdiff_t(y / spacing_) * rows() + column_phase / spacing_) * stride_ +
           Interleaving::kPad + column;
  }

 private:
  int rows() const { return Interleaving::kPeriod / spacing_; }

  int spacing_, height_;
  std::ptrdiff_t stride_;
};

/// Values of a picture in the order of a layout, not initialised.
template <class T>
class InterleavedValues {
 public:
  InterleavedValues() = default;
  explicit InterleavedValues(const auto& layout)
      : values_(std::make_unique_for_overwrite<T[]>(layout.size())) {
    prefer_large_pages(values_.get(), layout.size() * sizeof(T));
  }

  T* data() { return values_.get(); }
  const T* data() const { return values_.get(); }
  T& operator[](std::ptrdiff_t i) { return values_[std::size_t(i)]; }
  T operator[](std::ptrdiff_t i) const { return values_[std::size_t(i)]; }

  /// Sets a whole row, with what is outside the picture.
  void fill_row(const Interleaving& layout, int y, T value) {
    T* first = data() + layout.index(y, 0, -Interleaving::kPad);
    std::fill(first, first + Interleaving::kPeriod * layout.stride(), value);
  }

 private:
  std::unique_ptr<T[]> values_;
};

using InterleavedPlane = InterleavedValues<float>;
using InterleavedRatios = InterleavedValues<FixedRatio16>;

/// Vectors or colours of a picture in that order, coordinate by coordinate.
using InterleavedVectors = std::array<InterleavedPlane, 3>;
using InterleavedColorRatios = std::array<InterleavedRatios, 3>;

}  // namespace ssdo
