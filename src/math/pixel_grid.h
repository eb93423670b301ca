// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

#include "math/plane.h"

namespace ssdo {

/// Which pixels of a picture are read: some of its rows, or the middle one of every block of
/// `stride` x `stride` pixels. As the stride is odd, the middle of that pixel is the middle of its
/// block: what is read is a smaller picture by the same camera.
struct PixelGrid {
  int y0 = std::numeric_limits<int>::min(), y1 = std::numeric_limits<int>::max();  ///< rows
  int stride = 1;                                                                  ///< odd

  bool is_all() const { return *this == PixelGrid{}; }

  /// The rows of a window that are read, in the picture's pixels.
  Window rows_of(const Window& window) const;

  /// What is read of a window, in pixels of the smaller picture. Block (0, 0) begins at the pixel
  /// (0, 0).
  Window of(const Window& window) const;

  /// The pixel that is read of a block, along either axis.
  int middle(int block) const { return block * stride + stride / 2; }

  bool operator==(const PixelGrid&) const = default;
};

}  // namespace ssdo
