// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "io/exr/exr_reader.h"
#include "math/downsampling.h"
#include "scene/gbuffer.h"
#include "scene/layers/layers.h"

namespace ssdo {

/// The part that a layer is in.
const ExrPart& part_of(const std::vector<const ExrReader*>& files, const Layer& layer);

/// Whether a part is a picture of the small size.
bool has_size_of_outputs(const ExrPart& part, const Downsampling& downsampling);

/// Layers of one frame cover one picture, be they in several parts or files: throws
/// ExitCode::layer where the display window of one is not that of the position, or else of the
/// depth. Beauty, ambient and specular may have the size of the outputs instead. Data windows may
/// differ, as renderers that crop or add overscan write them.
void check_display_windows(const std::vector<const ExrReader*>& files, const LayerTable& table,
                           const std::vector<Role>& roles, const Downsampling& downsampling);

/// Warns of layers whose data window leaves out pixels where there is a surface, by how many, and
/// of pixels of another aspect. A normal that is left out becomes 0, which is rebuilt.
void note_data_windows(const std::vector<const ExrReader*>& files, const LayerTable& table,
                       const std::vector<Role>& roles, GBuffer& gbuffer);

}  // namespace ssdo
