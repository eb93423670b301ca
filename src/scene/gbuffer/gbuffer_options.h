// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <limits>
#include <optional>

#include "math/pixel_grid.h"
#include "scene/gbuffer.h"

namespace ssdo {

/// How to read the layers; all of it has defaults that fit most files.
struct GBufferOptions {
  std::optional<DepthKind> depth_kind;    ///< as the layer's name and P tell where not given
  float depth_near = 0, depth_far = 1;    ///< what 0 and 1 mean in a normalized depth
  std::optional<float> background_depth;  ///< depth from which on a pixel is background
  bool beauty = false;                    ///< whether a composite uses the colours of the beauty
  int downsample = 1;                     ///< how many times as large as the outputs the frame is
  PixelGrid grid = {};                    ///< the pixels that are read
  /// A frame with more pixels is read as an overview: one pixel of kOverviewStride x
  /// kOverviewStride.
  std::size_t most_pixels = std::numeric_limits<std::size_t>::max();
  std::optional<Space> space;             ///< of P and N; what they hold tells it where not given
  std::optional<Encodings> known;         ///< of all of the frame, where this is a part of it
  std::optional<glm::vec2> motion_scale;  ///< of the motion layer, to what Blender writes: pixels
                                          ///< to the frame before, y up; 1 where not given
};

}  // namespace ssdo
