// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/rays/find_sun.h"

#include <utility>

#include "estimators/bitmask/parts.h"

namespace ssdo {

SunShares find_sun(SunJob job, const Raster& raster, const Window& to, const Progress& progress) {
  const Interleaving& layout = job.march.scene.layout;
  SunShares found(layout);
  job.found = &found;
  InterleavedPlane first;
  if (job.directions.size() == 1) {
    first = raster.unknown();
    job.first = &first;
    for_each_tall_part_of(
        layout, grown(layout, to, Interleaving::kPeriod),
        [&](const Window& part) { march_first_rays(job, part); }, progress);
  }
  for_each_tall_part_of(
      layout, to, [&](const Window& part) { march_sun(job, part); }, progress);
  return found;
}

void hand_out_suns(std::vector<SunShares>& found, const Raster& raster,
                   std::vector<Plane<float>>& shares, std::vector<ShadowDraw>& draws) {
  for (SunShares& sun : found) {
    shares.push_back(raster.picture(std::move(sun.share), 1));
    draws.push_back({raster.picture(std::move(sun.weight), 1),
                     raster.picture(std::move(sun.width), kPenumbraUnit)});
  }
}

}  // namespace ssdo
