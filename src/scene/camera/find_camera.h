// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "error.h"
#include "scene/camera/camera.h"
#include "scene/camera/metadata/candidates.h"
#include "scene/gbuffer.h"
#include "scene/geometry.h"

namespace ssdo {

/// P leaves the camera open: its pixels lie in one plane, or are too few. The camera of another
/// frame of the sequence would settle it.
struct UndeterminedCamera : Error {
  using Error::Error;
};

/// The camera of the frame, and the transform from stored P to camera space. They are the same
/// unless P is stored in camera space and a file or the header gives the pose. Both are in the
/// pixels of the file, whatever the grid of the G-buffer.
struct FoundCamera {
  Camera camera, of_positions;
  bool world_given = false;  ///< --camera or the header gave the pose, and so the world
  /// Where the header gave it and P cannot prove it: that reading first, then the others that
  /// normals may decide for.
  std::vector<HeaderCamera> readings = {};
};

/// Decides by projection. The camera of the options is used if P projects to its own pixels under
/// it, or if no camera fits better; else the camera fitted from P, with a warning. Without options,
/// the camera is that fitted from P, and the header's where P or its lens agrees with it or where P
/// leaves the camera open. Where none of them tells it, it is that beside, moved to fit P.
/// Errors: ExitCode::layer where neither P nor the options nor the header determine the camera;
/// UndeterminedCamera where there is a P.
FoundCamera find_camera(const GBuffer& g, const CameraOptions& options, const std::string& file,
                        GeometryReport& report);

/// The most by which storing P may have moved it along one axis, in scene units.
double rounding_of_positions(const GBuffer& g);

}  // namespace ssdo
