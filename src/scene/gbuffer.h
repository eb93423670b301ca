// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "io/exr_reader.h"
#include "math/plane.h"
#include "scene/layers.h"

namespace ssdo {

/// What a depth layer measures. Distances are in scene units.
enum class DepthKind { planar, ray, inverse, normalized };

/// How to read the layers; all of it has defaults that fit most files.
struct GBufferOptions {
  std::optional<DepthKind> depth_kind;    ///< planar where not given
  float depth_near = 0, depth_far = 1;    ///< what 0 and 1 mean in a normalized depth
  std::optional<float> background_depth;  ///< depth from which on a pixel is background
};

/// The layers of one frame in the space and units of the file, with encodings undone. Every plane
/// covers `window`; a role that the frame does not have is an empty plane.
struct GBuffer {
  Window window, display;
  float pixel_aspect = 1;
  Plane<glm::vec3> position, normal, albedo, radiance;
  Plane<float> depth, alpha;                 ///< depth: along the axis or the ray, in scene units
  DepthKind depth_kind = DepthKind::planar;  ///< planar or ray: the others are undone
  Plane<unsigned char> valid;                ///< 1 geometry, 0 background or broken
  float position_step = 0;                   ///< relative rounding step of P (or depth) as stored
  std::size_t background_pixels = 0;
  std::size_t bad_pixels = 0;  ///< pixels with a NaN or infinity in a role that is used
  std::vector<std::string> warnings;
};

/// Reads the layers of `table` and finds background and broken pixels: background where alpha is
/// 0, or else by depth (>= 1e9, infinite, NaN, <= 0) where there is one, or else by P (0, >= 1e9,
/// not finite) or a normal of 0.
/// Errors: ExitCode::layer when there is neither position nor depth, or the depth has no unit.
GBuffer read_gbuffer(const std::vector<const ExrReader*>& files, const LayerTable& table,
                     const GBufferOptions& options);

}  // namespace ssdo
