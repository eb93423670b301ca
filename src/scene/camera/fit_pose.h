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

/// Finds the pose of a frame whose P leaves the camera open, down to a single pixel, from `beside`,
/// the camera of another frame of the sequence, with the same projection. P is brought onto its own
/// pixels; what P does not determine stays as in `beside`. The two are weighted by their precision,
/// so that a pose that P determines in full is not drawn towards `beside`. Returns nothing if P
/// does not come within half a pixel and `step`.
std::optional<Camera> fit_pose_near(const Camera& beside, const Plane<glm::vec3>& positions,
                                    const Plane<unsigned char>& valid, const Window& window,
                                    double step = 0);

}  // namespace ssdo
