// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "estimators/bitmask/jobs.h"
#include "estimators/bitmask/raster.h"
#include "estimators/products.h"
#include "parallel/tiles.h"

namespace ssdo {

/// How much of a source arrives at the pixels `to` of a raster. Where the result of the job goes is
/// set here.
SourceShares find_source(SourceJob job, const Window& to, const Progress& progress);

/// How much of a source arrives at the sides of `solids` that the camera does not see, as
/// SourceShares has it: what goes on beyond the frame hides nothing from them. The job's scene, of
/// the same pixels, is what blocks the light.
void find_unseen_light(SourceJob job, const MarchScene& solids, const Window& to,
                       SourceShares& found);

/// Turns what was found of sources into pictures, as LightShares has them, and frees it.
void hand_out_sources(std::vector<SourceShares>& found, const Raster& raster,
                      std::vector<Plane<float>>& shares, std::vector<ShadowDraw>& draws);

}  // namespace ssdo
