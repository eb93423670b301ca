// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/rays/find_source.h"

#include <utility>

#include "estimators/bitmask/parts.h"

namespace ssdo {

SourceVisibility find_source(SourceJob job, const Window& to, const Progress& progress) {
  const Interleaving& layout = job.march.scene.layout;
  SourceVisibility found(layout);
  job.found = &found;
  for_each_tall_part_of(
      layout, to, [&](const Window& part) { march_source(job, part); }, progress);
  return found;
}

void find_unseen_light(SourceJob job, const MarchScene& solids, const Window& to,
                       SourceVisibility& found) {
  const Interleaving& layout = job.march.scene.layout;
  found.unseen = InterleavedRatios(layout);
  job.unseen_of = &solids, job.found = &found;
  job.march.cut = nullptr;
  for_each_tall_part_of(layout, to, [&](const Window& part) { march_source(job, part); }, {});
}

void hand_out_sources(std::vector<SourceVisibility>& found, const Raster& raster,
                      std::vector<Plane<float>>& shares, std::vector<ShadowSample>& samples) {
  for (SourceVisibility& source : found) {
    shares.push_back(raster.picture(std::move(source.share), 1));
    samples.push_back({raster.picture(std::move(source.weight), 1),
                       raster.picture(std::move(source.width), kPenumbraUnit)});
  }
}

}  // namespace ssdo
