// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "math/plane.h"
#include "simd/interleaved.h"

namespace ssdo {

/// Pixels from 1 to `diagonal` for t from 0 to 1, dense at the start.
double march_distance(double t, double diagonal);

/// Where steps are longer than this, in pixels, all members of the pattern sample the same pixel of
/// each block of 4 x 4. These are few enough in the whole frame to stay in the cache; if each
/// member sampled a pixel of its own, most would come from memory.
constexpr double kLongStep = 32;
constexpr int kBlock = 4;

/// A pixel that a march samples, relative to the pixel where it starts, and the stretch of the
/// march that it represents: halfway to the samples before and after.
struct SliceStep {
  float dx, dy;           ///< pixels, y down
  int row;                ///< dy as a whole number, or rows of OverviewRaster
  int column_shift;       ///< of the entry, within its interleaved row
  std::ptrdiff_t offset;  ///< of the index
  float inner, outer;     ///< ends of the stretch, over the pixel's distance
  float inner_px;
};

/// One side of a slice.
struct SliceSide {
  std::vector<SliceStep> steps;  ///< near to far
  std::size_t near_steps = 0;    ///< those that are in the raster; the others are in OverviewRaster
  float phase;                   ///< in 0..1: place of the sample point within every sector
};

/// A plane through the view ray, given by its line in the picture.
struct Slice {
  float dx, dy;        ///< unit, pixels, y down
  SliceSide sides[2];  ///< along (dx, dy) and against it
};

/// An overview of the frame in which marches go on from some distance on, for a raster that is a
/// part of the frame. A pixel of it stands for kPeriod x kPeriod pixels, counted from the first
/// pixel of the display window, and shows what the one in their middle does. Its rows are not
/// interleaved: pixels of a vector, which are kPeriod apart, see neighbours in it. Each of its rows
/// takes the place of every eighth pixel of a row of `layout`.
struct OverviewRaster {
  Interleaving layout;
  int width, height;
  int first_x, first_y;  ///< its pixel (0, 0) among those that cover the display window
  float from_px;         ///< how far away it begins

  OverviewRaster(int w, int h, int x, int y, float from)
      : layout(w * Interleaving::kPeriod, (h + Interleaving::kPeriod - 1) / Interleaving::kPeriod,
               0),
        width(w),
        height(h),
        first_x(x),
        first_y(y),
        from_px(from) {}

  std::ptrdiff_t index(int x, int y) const {
    return layout.index(y >> Interleaving::kShift, y & (Interleaving::kPeriod - 1), x);
  }
};

/// The slices of every member of the T x T pattern, T = Interleaving::kPeriod, row by row. All
/// members together divide the half-circle evenly.
class SlicePattern {
 public:
  /// `steps` per side, from one pixel to the diagonal of `display`. Of `spacing` x `spacing`
  /// pixels, 1 or a power of two, one marches; the others have no slices.
  /// `far` may be null.
  SlicePattern(const Interleaving& layout, const Window& display, int slices, int steps,
               unsigned seed, int spacing = 1, const OverviewRaster* far = nullptr);

  int spacing() const { return spacing_; }

  /// 1 or -1: which half of a member's slices counts as the first half. With these signs each half
  /// covers all directions about evenly, both within a pixel and over the pixels that a filter
  /// averages, so that the difference of the halves is noise. With the same sign everywhere, one
  /// half would hold certain directions only, and the difference would depend on the scene.
  float half_sign(int column, int row) const {
    return half_signs_[std::size_t(row * Interleaving::kPeriod + column)];
  }

  /// The largest distance in rows between a pixel and the samples of its march, where all that
  /// matters lies within `reach_px` of the pixel.
  int rows_within(float reach_px) const;

  /// The rank of each member, 0..T^2 - 1, in an order that puts neighbours far apart.
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
