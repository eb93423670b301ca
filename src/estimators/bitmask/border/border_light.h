// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "estimators/bitmask/march_scene.h"
#include "scene/light/source.h"
#include "simd/interleaved.h"

namespace ssdo {

/// A colour for each pixel at the border, by channel.
using SentAtBorder = std::array<BorderValues, 3>;

/// What the front sides of the pixels at the border send; 0 for pixels without a surface.
/// `radiance` is what pixels send, `two_sided` as SenderJob has it.
SentAtBorder sent_at_border(const MarchScene& scene, const InterleavedVectors& radiance,
                            bool two_sided);

/// The direct light of one lamp that the pixels at the border send. Beyond the border it falls off
/// with the distance to the lamp, and ends with its cone (border/lamp_beyond-inl.h).
struct LampBeyond {
  const Source* lamp;
  SentAtBorder sent;
};

/// What pixels at the border send of other light than that of these lamps, which is a part of it.
SentAtBorder without_lamps(SentAtBorder sent, const std::vector<LampBeyond>& lamps);

/// What surfaces send that are assumed to continue beyond the border of the frame
/// (border/extension-inl.h): what the pixel at the border sends, but no more than `level` in
/// luminance, Emitters::bright. A pixel tells where a surface goes on, but not that its light does:
/// paper in the sun that touches the border would be continued by many times its size. `sent` is of
/// one light or of all, which `of_all` has.
SentAtBorder light_beyond(SentAtBorder sent, const SentAtBorder& of_all, float level);

/// What surfaces send, as light_beyond() has it.
struct SentByAll {
  const InterleavedVectors& radiance;
  const InterleavedVectors& of_all;
  bool two_sided;
  float level;
  int rows_apart;  ///< one row of the display window in so many counts
};

/// The mean over the surfaces of the display window of what their fronts send, no more than `level`
/// each.
glm::vec3 mean_sent(const MarchScene& scene, const Geometry& geometry, const SentByAll& sent);

}  // namespace ssdo
