// SPDX-License-Identifier: Apache-2.0
#include "filters/shot/seen_by_others.h"

#include <cmath>

#include "filters/shot/sights.h"

namespace ssdo {

SeenByOthers seen_by(const std::vector<const KeptSurfaces*>& others, const KeptSurfaces& own) {
  SeenByOthers shown;
  if (!own.world_known) return shown;
  std::vector<ShotReprojection> reprojections;
  for (const KeptSurfaces* other : others)
    if (other->world_known) reprojections.emplace_back(*other, own);
  shown.frames = int(reprojections.size());
  long points = 0, some = 0, times = 0, through = 0;
  RowOfPoints at;
  Sights sights;
  for_each_points_of_grid(own, grid_step(own), [&](const RowOfPixels& row) {
    load_points(own, row, at);
    int shows[RowOfPoints::kMost] = {}, looks[RowOfPoints::kMost] = {};
    for (const ShotReprojection& reprojection : reprojections) {
      unsigned char is_through[RowOfPoints::kMost];
      const bool found = reprojection.find(at, sights);
      reprojection.find_through(at, is_through);
      for (int i = 0; i < row.count; ++i) {
        shows[i] += found && sights.pixel[i] >= 0;
        looks[i] += is_through[i];
      }
    }
    for (int i = 0; i < row.count; ++i) {
      if (std::isnan(at.position[0][i])) continue;
      ++points, some += shows[i] > 0, times += shows[i], through += looks[i] > 0;
    }
  });
  if (points == 0) return shown;
  shown.some = double(some) / double(points);
  shown.times = double(times) / double(points);
  shown.through = double(through) / double(points);
  return shown;
}

}  // namespace ssdo
