// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

#include "scene/gbuffer.h"
#include "scene/geometry.h"
#include "scene/light/environment.h"

namespace ssdo {

/// Which axis of the world is up, and what says so.
struct WorldUp {
  UpAxis axis = UpAxis::y;
  std::string source;   ///< "by the header", "by the camera, 160 to 1", "a guess"
  std::string warning;  ///< where it is a guess, or header and camera disagree; else empty
  bool known = true;    ///< false: a guess
};

/// How likely the axes y, z, x, -y, -z and -x are up, by the camera and the surfaces of a frame, or
/// of several: logarithms, up to a constant.
using UpEvidence = std::array<double, 6>;

UpEvidence up_evidence(const Geometry& geometry);

/// Whether the header decides which axis is up.
bool header_tells_up(const GBuffer& g);

/// The header decides where a renderer with one world wrote it: Blender and Unreal have z up. Else
/// the camera and the surfaces do: a camera stands level, its right axis being perpendicular to up,
/// looks up or down by little, and sees more floors than ceilings. Where they do not tell surely
/// between y and z, as under a camera that looks along an axis and steeply down, y is up. `of_shot`
/// is the evidence of several frames of a sequence, in place of that of this one.
WorldUp find_world_up(const GBuffer& g, const Geometry& geometry,
                      const std::optional<UpEvidence>& of_shot = std::nullopt);

}  // namespace ssdo
