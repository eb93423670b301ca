// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "plan/outputs.h"
#include "plan/plan.h"
#include "scene/gbuffer.h"
#include "scene/scene.h"

namespace ssdo {

/// Decides from what was asked for and what the frame shows: work that cannot change a product
/// that is written is left out.
/// Errors: ExitCode::usage for a product that the method does not make, several for one picture, or
/// a crop that leaves nothing; ExitCode::layer for one whose layer is missing.
Plan make_plan(const ModelOptions& model, const OutputOptions& output, const Scene& scene,
               const GBuffer& gbuffer, const std::string& file);

/// Whether --radius auto is a length in scene units that is found in frames.
bool finds_radius(const ModelOptions& model);

/// This length by one frame: 0.3 of the height that it shows at the median depth of its surfaces.
float radius_by_frame(const Geometry& geometry);

}  // namespace ssdo
