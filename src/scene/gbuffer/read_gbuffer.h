// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec2.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "io/exr/exr_reader.h"
#include "math/pixel_grid.h"
#include "scene/gbuffer.h"
#include "scene/gbuffer/gbuffer_options.h"
#include "scene/layers/layers.h"

namespace ssdo {

/// What rendered layers show.
struct Rendered {
  Plane<glm::vec3> color;  ///< the beauty, or else the ambient layer
  Plane<float> alpha;      ///< 0 where the frame has none
};

/// Reads the rendered layers over `window`, in pixels of the file, at the size of the outputs. What
/// is not finite is 0. Errors: ExitCode::input for a window that does not fit into memory.
Rendered read_rendered(const std::vector<const ExrReader*>& files, const LayerTable& table,
                       const Window& window, const Downsampling& downsampling);

/// Reads the layers of `table` and finds background and broken pixels: background where alpha is
/// 0, or else by depth (>= 1e9, infinite, NaN, <= 0) where there is one, or else by P (0, >= 1e9,
/// not finite) or a normal of 0.
/// The table has a position or a depth, whose data window the planes have; with `options.beauty`
/// they cover the rendered layers too. `deep` is the depth of a deep part, decoded but for its kind
/// (planar or ray). Rendered layers may have the size of
/// the outputs; if they have that of the other layers, they are filtered to it. Errors:
/// ExitCode::layer when a layer is of another display window, or the depth has no unit;
/// ExitCode::usage when `options.downsample` does not divide the display window.
GBuffer read_gbuffer(const std::vector<const ExrReader*>& files, const LayerTable& table,
                     const GBufferOptions& options, const Plane<float>* deep = nullptr);

}  // namespace ssdo
