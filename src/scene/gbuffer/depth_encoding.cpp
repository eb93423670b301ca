// SPDX-License-Identifier: Apache-2.0
#include "scene/gbuffer/depth_encoding.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "error.h"
#include "math/infinity.h"
#include "scene/gbuffer/background.h"
#include "scene/layers/depth_names.h"

namespace ssdo {
namespace {

/// Rounding of the farther end, relative to it.
constexpr float kDepthRounding = 1e-6f;

/// Whether the depth is the z of a camera that looks along -z: negative wherever there is a
/// surface.
bool is_negative(const Plane<float>& depth) {
  bool negative = false;
  for (const float z : depth.pixels) {
    if (z > 0 && z < kEmptyDepth) return false;
    negative |= z < 0 && z > -kEmptyDepth;
  }
  return negative;
}

void turn(GBuffer& g) {
  for (float& z : g.depth.pixels) z = -z;
  g.warnings.push_back(
      "depth is negative, as the z of a camera that looks along -z; its sign is turned");
}

void check_has_unit(const GBuffer& g, const std::string& file, const Layer* layer) {
  const DepthName* named = layer ? find_depth_name(*layer) : nullptr;
  if (named && named->kind == DepthKind::normalized) {
    throw Error(ExitCode::layer,
                fmt::format("{}: depth '{}' has no known unit: {}; give its ends with --depth-kind "
                            "normalized:NEAR,FAR, or say --depth-kind planar if these are scene "
                            "units",
                            file, layer->name, named->reason));
  }
  float largest = 0;
  for (const float z : g.depth.pixels) {
    if (z < kEmptyDepth) largest = std::max(largest, z);
  }
  if (largest > 1 || largest == 0) return;  // 0: nothing is shown
  throw Error(
      ExitCode::layer,
      fmt::format("{}: depth ends at {:.4g} and seems to be normalised to 0..1, or 1 / Z; give "
                  "its meaning with --depth-kind normalized:NEAR,FAR or --depth-kind "
                  "inverse, or say --depth-kind planar if these are scene units",
                  file, largest));
}

}  // namespace

float decoded_depth(float stored, const GBufferOptions& options) {
  const float near = options.depth_near, far = options.depth_far;
  switch (options.depth_kind.value_or(DepthKind::planar)) {
    case DepthKind::inverse:
      return 1 / stored;
    case DepthKind::normalized: {
      const float depth = near + stored * (far - near);
      return depth >= std::max(near, far) * (1 - kDepthRounding) ? kInfinity : depth;
    }
    default:
      return stored;
  }
}

void undo_depth_encoding(GBuffer& g, const GBufferOptions& options, const std::string& file,
                         const Layer* layer) {
  if (g.depth.empty()) return;
  const DepthName* named = layer ? find_depth_name(*layer) : nullptr;
  const bool ray_by_name = named && named->kind == DepthKind::ray;
  const DepthKind kind =
      options.depth_kind.value_or(ray_by_name ? DepthKind::ray : DepthKind::planar);
  g.depth_kind = kind == DepthKind::ray ? DepthKind::ray : DepthKind::planar;
  g.depth_source = options.depth_kind ? "--depth-kind" : ray_by_name ? "its name" : "";
  for (float& z : g.depth.pixels) z = decoded_depth(z, options);
  const std::optional<Encodings>& known = options.known;
  g.encodings.depth_is_negative = known ? known->depth_is_negative : is_negative(g.depth);
  if (g.encodings.depth_is_negative) turn(g);
  if (!options.depth_kind && g.position.empty() && !known) check_has_unit(g, file, layer);
}

}  // namespace ssdo
