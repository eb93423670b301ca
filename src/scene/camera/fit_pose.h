// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "math/plane.h"
#include "scene/camera/camera.h"

namespace ssdo {

/// Finds the pose of a camera whose projection is known, from positions that may lie in a plane.
/// Returns nothing for fewer than four pixels or pixels in a line, or where no pose brings the
/// positions within half a pixel and `step`, by which P may have been rounded, in scene units.
std::optional<Camera> fit_pose(const Camera& projection, const Plane<glm::vec3>& positions,
                               const Plane<unsigned char>& valid, const Window& window,
                               double step = 0);

/// Finds the pose of a frame of a sequence that leaves its camera open, down to a single pixel,
/// from `beside`, the camera of another frame, whose projection it has: P is brought onto its own
/// pixels, and what P does not tell stays as it is beside. Between the two, the balance is that of
/// their precision, so that a pose that P tells in full is not drawn to the other. Returns nothing
/// where that does not bring P within half a pixel and `step`.
std::optional<Camera> fit_pose_beside(const Camera& beside, const Plane<glm::vec3>& positions,
                                      const Plane<unsigned char>& valid, const Window& window,
                                      double step = 0);

}  // namespace ssdo
