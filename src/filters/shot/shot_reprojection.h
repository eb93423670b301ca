// SPDX-License-Identifier: Apache-2.0
//
// What other frames of a shot show at the points of one frame, for many points at a time.
#pragma once

#include <algorithm>
#include <cstdint>

#include "filters/shot/kept_surfaces.h"

namespace ssdo {

/// Points of a frame, side by side or a few pixels apart in a row.
struct RowOfPoints {
  static constexpr int kMost = 64;

  int count = 0;
  /// Camera space; not-a-number where there is no surface, and from `count` on.
  alignas(64) float position[3][kMost];
  alignas(64) float normal[3][kMost], rounding[kMost];
};

/// Points at (x, y), (x + step, y), ...; at most RowOfPoints::kMost.
struct RowOfPixels {
  int x, y, step, count;
};
void load_points(const KeptSurfaces& own, const RowOfPixels& row, RowOfPoints& points);

/// The step of a grid that has about 480 points across a frame: enough to find what moves or glows.
inline int grid_step(const KeptSurfaces& own) { return std::max(1, own.window.width() / 480); }

/// Calls visit(RowOfPixels) for all pixels of a grid of that step, in order.
template <class Visit>
void for_each_points_of_grid(const KeptSurfaces& own, int step, const Visit& visit) {
  const int width = own.window.width(), columns = (width + step - 1) / step;
  for (int y = 0; y < own.window.height(); y += step) {
    for (int column = 0; column < columns; column += RowOfPoints::kMost)
      visit(RowOfPixels{column * step, y, step, std::min(RowOfPoints::kMost, columns - column)});
  }
}

/// Where another frame shows the points.
struct ReprojectedPoints {
  /// The upper left of the four pixels around a point, by KeptSurfaces::index(); -1: not shown.
  alignas(64) std::int32_t pixel[RowOfPoints::kMost];
  /// Weights of the four pixels, row by row, with the sum 1. 0: the pixel shows another surface.
  alignas(64) float weight[4][RowOfPoints::kMost];
};

/// Finds the points of a frame in another frame. Reprojection is the reference; this class assumes
/// that points stand still, and works in single precision, which moves points by a thousandth of a
/// pixel at most where they are no farther than 10,000 times the camera's step. The same bits for
/// every instruction set.
class ShotReprojection {
 public:
  /// Both must know the world, and `other` has to outlive it.
  ShotReprojection(const KeptSurfaces& other, const KeptSurfaces& own);

  /// False where the other frame shows none of the points; `sights` then hold nothing. Where
  /// `through` is given, it is filled as by find_through().
  bool find(const RowOfPoints& points, ReprojectedPoints& sights,
            unsigned char* through = nullptr) const;

  /// Sets through[i] to 1 where the other frame does not show point i but what lies behind its
  /// place (SeenBefore::through), else to 0.
  void find_through(const RowOfPoints& points, unsigned char* through) const;

  /// From the camera space of `own` to that of `other`, row by row, and from there to pixels of
  /// `other`, counted from the centre of the first one.
  struct View {
    float turn[9], step[3];
    float fx, fy, cx, cy;
    float half_pixel;  ///< half the width of a pixel at depth 1
    bool orthographic;
    int width, height, stride;
    std::uint32_t least_rounding;
    const KeptSurface* pixels;
  };

 private:
  View view_;
};

}  // namespace ssdo
