// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "math/plane.h"

namespace ssdo {

/// The period of the pattern of marches, so that samples at the same offset from the pixels of a
/// vector are side by side in an overview.
inline constexpr int kOverviewStride = 8;

/// Which pixels of a picture are read: some of its rows, or one in the middle of every block of
/// `stride` x `stride` pixels, which make a smaller picture by the same camera.
struct PixelGrid {
  int y0 = std::numeric_limits<int>::min(), y1 = std::numeric_limits<int>::max();  ///< rows
  int stride = 1;
  int origin_x = 0, origin_y = 0;  ///< the first pixel of block (0, 0); 0 where the stride is 1

  bool is_coarse() const { return stride > 1; }

  /// The rows of a window that are read, in the picture's pixels.
  Window rows_of(const Window& window) const;

  /// What is read of a window, in pixels of the smaller picture.
  Window of(const Window& window) const;

  /// The pixel that is read of a block.
  int middle_x(int block) const { return origin_x + block * stride + stride / 2; }
  int middle_y(int block) const { return origin_y + block * stride + stride / 2; }

  bool operator==(const PixelGrid&) const = default;
};

}  // namespace ssdo
