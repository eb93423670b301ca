// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/plane.h"

namespace ssdo {

/// How a picture becomes one with N times fewer pixels in a row and in a column. Both have the
/// upper left corner of their display windows in common.
struct Downsampling {
  /// Width of the pixel filter in pixels of the small picture. It is the Blackman-Harris filter of
  /// Cycles, whose default "width" of 1.5 is its reach to each side (measured).
  static constexpr int kFilterWidth = 3;

  int factor = 1;  ///< N; 1: both are the same
  Window display;  ///< of the large picture; N divides its width and height

  bool is_identity() const { return factor == 1; }

  /// The window of the small picture that covers `large`, a window of the large one. Pixels at its
  /// border may be covered in part.
  Window small(const Window& large) const;

  /// The window of the large picture that the pixels of `small` cover.
  Window large(const Window& small) const;

  /// How far the filter reaches beyond the pixels that a pixel of the small picture covers, in
  /// pixels of the large one.
  int reach() const { return is_identity() ? 0 : (kFilterWidth - 1) * factor / 2; }
};

}  // namespace ssdo
