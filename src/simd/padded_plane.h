// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>

#include "simd/width.h"

namespace ssdo {

/// Where the pixels of a picture lie in planes whose rows may be read by whole vectors from
/// anywhere in them: every row has kPad entries more on both sides. The length of a row is an odd
/// number of cache lines: at a power of two, pixels below each other would share a few places of
/// the cache.
struct PaddedLayout {
  static constexpr int kPad = kMostLanes;

  int width, height;
  std::ptrdiff_t stride;

  PaddedLayout(int w, int h)
      : width(w), height(h), stride((((w + kPad - 1) / kPad + 2) | 1) * std::ptrdiff_t(kPad)) {}

  std::size_t size() const { return std::size_t(stride) * std::size_t(height); }
};

/// Values of a picture, row by row, not initialised.
class PaddedPlane {
 public:
  explicit PaddedPlane(const PaddedLayout& layout)
      : values_(std::make_unique_for_overwrite<float[]>(layout.size())), stride_(layout.stride) {}

  /// The pixel (0, y). May be read from -kPad to width + kPad.
  float* row(int y) { return values_.get() + y * stride_ + PaddedLayout::kPad; }
  const float* row(int y) const { return values_.get() + y * stride_ + PaddedLayout::kPad; }

  /// Sets a whole row, with what is outside the picture.
  void fill_row(int y, float value) { std::fill_n(row(y) - PaddedLayout::kPad, stride_, value); }

 private:
  std::unique_ptr<float[]> values_;
  std::ptrdiff_t stride_;
};

}  // namespace ssdo
