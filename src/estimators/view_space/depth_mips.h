// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <utility>

#include "estimators/view_space/view_planes.h"

namespace ssdo {

/// The depth of a frame at halved, quartered, ... resolution, as Scalable Ambient Obscurance reads
/// it (McGuire, Mara, Luebke 2012, section 2.2): a pixel of a level is one of the four below it,
///
///   Z_k(x, y) = Z_{k-1}(2x + (y mod 2), 2y + (x mod 2)),
///
/// a rotated grid. It is never an average, which would be the depth of nothing that is there.
///
/// x and y count from the corner of the display window, so that a crop has the same levels; a pixel
/// that stands for one which the data window lacks stands for its neighbour.
///
/// All levels lie in one array with one stride, below each other: level k starts after
/// 2 rows - (2 rows >> k) rows. A vector of which each lane reads another level needs no table.
class DepthMips {
 public:
  static constexpr int kCoarsest = 5;  ///< as in the authors' code

  explicit DepthMips(const ViewPlanes& planes);

  /// The z that a level shows at the full-resolution pixel (x, y) of the data window; camera space,
  /// negative, or kBackgroundDepth.
  float at(int level, int x, int y) const {
    return row(level, (y + top_) >> level)[(x + left_) >> level];
  }

  /// For vector loops: the first value, and where (x, y) of the data window is in these terms.
  const float* data() const { return values_.get(); }
  int stride() const { return stride_; }
  int left() const { return left_; }  ///< added to x before it is halved
  int top() const { return top_; }    ///< added to y
  int twice_rows() const { return 2 * rows_; }

 private:
  /// Places repeat their parity on every level after this many pixels.
  static constexpr int kPeriod = 2 << kCoarsest;

  const float* row(int level, int y) const {
    const std::ptrdiff_t start = 2 * rows_ - ((2 * rows_) >> level);
    return values_.get() + (start + y) * stride_;
  }
  float* row(int level, int y) { return const_cast<float*>(std::as_const(*this).row(level, y)); }

  int left_, top_, rows_, stride_;
  std::unique_ptr<float[]> values_;
};

}  // namespace ssdo
