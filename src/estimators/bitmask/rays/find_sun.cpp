// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/rays/find_sun.h"

#include <utility>

#include "estimators/bitmask/parts.h"

namespace ssdo {

SunShares find_sun(SunJob job, const Window& to, const Progress& progress) {
  const Interleaving& layout = job.march.scene.layout;
  SunShares found(layout);
  job.found = &found;
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
