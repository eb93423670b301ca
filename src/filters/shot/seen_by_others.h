// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "filters/shot/kept_surfaces.h"

namespace ssdo {

/// How much of the surfaces of one frame other frames of its shot show: shares of the points of a
/// grid.
struct SeenByOthers {
  int frames = 0;      ///< others that know the world
  double some = 0;     ///< the share that at least one of them shows
  double times = 0;    ///< how many of them show a point, in the mean
  double through = 0;  ///< the share that has moved: one of them looks through its place
};

/// Counts the shown points, one frame after the other, on a grid of about 480 across the frame. A
/// frame without a world shows nothing, and points without a surface do not count.
class ShownPoints {
 public:
  /// `own` has to outlive it.
  explicit ShownPoints(const KeptSurfaces& own) : own_(own) {}

  void add(const KeptSurfaces& other);
  SeenByOthers count() const;

 private:
  struct Point {
    int shows = 0;  ///< how many frames show it
    bool through = false;
  };

  const KeptSurfaces& own_;
  int frames_ = 0;
  std::vector<Point> points_;  ///< those with a surface, in the order of the grid
};

}  // namespace ssdo
