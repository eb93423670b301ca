// SPDX-License-Identifier: Apache-2.0
#include "filters/shot/seen_by_others.h"

#include <cmath>
#include <cstddef>

#include "filters/shot/shot_reprojection.h"

namespace ssdo {

void ShownPoints::add(const KeptSurfaces& other) {
  if (!own_.world_known || !other.world_known) return;
  ++frames_;
  const ShotReprojection reprojection(other, own_);
  RowOfPoints at;
  ReprojectedPoints sights;
  unsigned char through[RowOfPoints::kMost];
  std::size_t number = 0;
  for_each_points_of_grid(own_, grid_step(own_), [&](const RowOfPixels& row) {
    load_points(own_, row, at);
    const bool found = reprojection.find(at, sights, through);
    for (int i = 0; i < row.count; ++i) {
      if (std::isnan(at.position[0][i])) continue;
      if (number == points_.size()) points_.emplace_back();
      Point& point = points_[number++];
      point.shows += found && sights.pixel[i] >= 0;
      point.through = point.through || through[i] > 0;
    }
  });
}

SeenByOthers ShownPoints::count() const {
  SeenByOthers shown;
  shown.frames = frames_;
  for (const Point& point : points_)
    shown.some += point.shows > 0, shown.times += point.shows, shown.through += point.through;
  if (points_.empty()) return shown;
  for (double* sum : {&shown.some, &shown.times, &shown.through}) *sum /= double(points_.size());
  return shown;
}

}  // namespace ssdo
