// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "scene/gbuffer.h"
#include "scene/gbuffer/gbuffer_options.h"
#include "scene/layers/layer_table.h"

namespace ssdo {

/// A depth as stored as a distance along the axis or the ray, in scene units; infinite where it
/// shows nothing by the rule below.
float decoded_depth(float stored, const GBufferOptions& options);

/// Turns the depth as stored into a distance along the axis or the ray, in scene units, and sets
/// its kind, which is that of the options, or else what the name of `layer` says. In a normalized
/// depth what is stored as the farther end, or beyond it, shows nothing: it becomes infinite. A
/// depth that is negative throughout is a coordinate along the axis: its sign is turned, with a
/// warning. Errors: ExitCode::layer where there is no P for a depth within 0..1 of unknown meaning,
/// or one that its tool remaps. With `options.known`, what it says is done.
void undo_depth_encoding(GBuffer& g, const GBufferOptions& options, const std::string& file,
                         const Layer* layer = nullptr);

}  // namespace ssdo
