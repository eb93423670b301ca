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
SourceVisibility find_source(SourceJob job, const Window& to, const Progress& progress);

/// How much of a source arrives at the sides of `solids` that the camera does not see, as
/// SourceVisibility has it: what goes on beyond the frame hides nothing from them. The job's scene,
/// of the same pixels, is what blocks the light.
void find_unseen_light(SourceJob job, const MarchScene& solids, const Window& to,
                       SourceVisibility& found);

/// Turns what was found of sources into pictures, as LightVisibility has them, and frees it.
void hand_out_sources(std::vector<SourceVisibility>& found, const Raster& raster,
                      std::vector<Plane<float>>& shares, std::vector<ShadowSample>& samples);

}  // namespace ssdo
