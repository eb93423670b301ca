// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "scene/camera/camera.h"
#include "scene/gbuffer.h"
#include "scene/geometry.h"

namespace ssdo {

/// The camera of the frame, and what leads from P as it is stored to camera space: the same, unless
/// P is in camera space already while a file gives the pose.
struct FoundCamera {
  Camera camera, of_positions;
  bool by_file = false;  ///< --camera gave the pose, and so the world
};

/// Decides by projection: a camera that the options give is taken if P keeps to its pixels under
/// it, or if there is nothing better; else the one that P itself shows, with a warning.
/// Errors: ExitCode::layer where neither P nor the options determine the camera.
FoundCamera find_camera(const GBuffer& g, const CameraOptions& options, const std::string& file,
                        GeometryReport& report);

}  // namespace ssdo
