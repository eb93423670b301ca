// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <glm/vec3.hpp>

#include "estimators/bitmask/march_scene.h"
#include "simd/interleaved.h"

namespace ssdo {

/// What surfaces send that are assumed to continue beyond the border of the frame
/// (border/extension-inl.h), by channel: what the pixel at the border sends, but no more than
/// `level` in luminance, Emitters::bright. A pixel tells where a surface goes on, but not that its
/// light does: paper in the sun that touches the border would be continued by many times its size.
/// `radiance` is what pixels send, of one light or of all, which `of_all` has; `two_sided` as
/// SenderJob has it.
std::array<BorderValues, 3> light_beyond(const MarchScene& scene,
                                         const InterleavedVectors& radiance,
                                         const InterleavedVectors& of_all, bool two_sided,
                                         float level);

/// What surfaces send, as light_beyond() has it.
struct SentByAll {
  const InterleavedVectors& radiance;
  const InterleavedVectors& of_all;
  bool two_sided;
  float level;
};

/// The mean over the surfaces of the display window of what their fronts send, no more than `level`
/// each.
glm::vec3 mean_sent(const MarchScene& scene, const Geometry& geometry, const SentByAll& sent);

}  // namespace ssdo
