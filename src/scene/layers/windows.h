// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "io/exr/exr_reader.h"
#include "math/downsampling.h"
#include "scene/gbuffer.h"
#include "scene/layers/layers.h"

namespace ssdo {

/// The smallest window that holds both.
inline Window hull(const Window& a, const Window& b) {
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

/// The part that a layer is in.
const ExrPart& part_of(const std::vector<const ExrReader*>& files, const Layer& layer);

/// The layers that composites of a beauty are made of.
inline const std::vector<Role> kRendered = {Role::beauty, Role::ambient, Role::specular,
                                            Role::light};

/// What the outputs of a frame cover, in pixels of its files: the data window of the position, or
/// else of the depth, and for `composites` of a beauty those of its layers.
Window window_of_outputs(const std::vector<const ExrReader*>& files, const LayerTable& table,
                         bool composites, const Downsampling& downsampling);

/// The window of a frame whose outputs cover `outputs`. Renderers crop a layer to what it shows: on
/// a side where the position ends before other layers, there is background. A side that ends with
/// the display window is an exception: what lies beyond is unknown, and the frame ends there too.
Window window_of_frame(const ExrPart& lead, const Window& outputs);

/// Whether a part is a picture of the small size.
bool has_size_of_outputs(const ExrPart& part, const Downsampling& downsampling);

/// Layers of one frame cover one picture, be they in several parts or files: throws
/// ExitCode::layer where the display window of one is not that of the position, or else of the
/// depth. Rendered layers may have the size of the outputs instead. Data windows may
/// differ, as renderers that crop or add overscan write them.
void check_display_windows(const std::vector<const ExrReader*>& files, const LayerTable& table,
                           const std::vector<Role>& roles, const Downsampling& downsampling);

/// Warns of layers whose data window leaves out pixels where there is a surface, by how many, and
/// of pixels of another aspect. A normal that is left out becomes 0, which is rebuilt.
void note_data_windows(const std::vector<const ExrReader*>& files, const LayerTable& table,
                       const std::vector<Role>& roles, GBuffer& gbuffer);

}  // namespace ssdo
