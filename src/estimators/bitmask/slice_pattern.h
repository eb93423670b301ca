// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "math/plane.h"
#include "simd/interleaved.h"

namespace ssdo {

/// Pixels from 1 to `diagonal` for t from 0 to 1, dense at the start.
double march_distance(double t, double diagonal);

/// Where steps are longer than this, in pixels, one pixel in each block of 4 x 4 serves all members
/// of the pattern. Of the whole frame these are few enough to stay in the cache, where the pixels
/// that each member would choose for itself come from memory every time.
constexpr double kLongStep = 32;

/// A pixel that a march looks at, seen from the pixel where it starts, and the stretch of the way
/// that it stands for: half way to the pixels before and after.
struct SliceStep {
  float dx, dy;           ///< pixels, y down
  int row;                ///< dy as a whole number
  int column_shift;       ///< of the entry, within its interleaved row
  std::ptrdiff_t offset;  ///< of the index
  float inner, outer;     ///< ends of the stretch, over the pixel's distance
  float inner_px;
};

/// One side of a slice.
struct SliceSide {
  std::vector<SliceStep> steps;  ///< near to far
  float phase;  ///< in 0..1: where in every sector the point lies that stands for it
};

/// A plane through the view ray, given by its line in the picture.
struct Slice {
  float dx, dy;        ///< unit, pixels, y down
  SliceSide sides[2];  ///< along (dx, dy) and against it
};

/// The slices of every member of the T x T pattern, T = Interleaving::kPeriod, row by row. All
/// members together divide the half-circle evenly.
class SlicePattern {
 public:
  /// `steps` per side, from one pixel to the diagonal of `display`. Of `spacing` x `spacing`
  /// pixels, 1 or a power of two, one marches; the others have no slices.
  SlicePattern(const Interleaving& layout, const Window& display, int slices, int steps,
               unsigned seed, int spacing = 1);

  int spacing() const { return spacing_; }

  /// 1 or -1: which half of a member's slices belongs to the first half of all slices. With these
  /// signs each half covers all directions about evenly, in one pixel and in all that a filter
  /// averages, so that the difference of the two is noise. With the same sign everywhere, one
  /// half would have the slices of some directions, and the difference would show what stands
  /// there.
  float half_sign(int column, int row) const {
    return half_signs_[std::size_t(row * Interleaving::kPeriod + column)];
  }

  /// The rank of each member in an order in which neighbours are far apart, 0..T^2 - 1.
  static int rank(int member);

  const std::vector<Slice>& member(int column, int row) const {
    return members_[std::size_t(row * Interleaving::kPeriod + column)];
  }

 private:
  std::vector<std::vector<Slice>> members_;
  std::vector<float> half_signs_;
  int spacing_;
};

}  // namespace ssdo
