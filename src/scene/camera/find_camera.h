// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "scene/camera/camera.h"
#include "scene/gbuffer.h"
#include "scene/geometry.h"

namespace ssdo {

/// The camera of the frame, and the transform from stored P to camera space. They are the same
/// unless P is stored in camera space and a file gives the pose. Both are in the pixels of the
/// file, whatever the grid of the G-buffer.
struct FoundCamera {
  Camera camera, of_positions;
  bool by_file = false;  ///< --camera gave the pose, and so the world
};

/// Decides by projection: the camera of the options is used if P projects to its own pixels under
/// it, or if no camera fits better; else the camera fitted from P, with a warning.
/// Errors: ExitCode::layer where neither P nor the options determine the camera.
FoundCamera find_camera(const GBuffer& g, const CameraOptions& options, const std::string& file,
                        GeometryReport& report);

}  // namespace ssdo
