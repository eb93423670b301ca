// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "scene/camera/camera.h"
#include "scene/camera/metadata/candidates.h"

namespace ssdo {

/// The camera of the frame, and the transform from stored P to camera space. They are the same
/// unless P is stored in camera space and a file or the header gives the pose. Both are in the
/// pixels of the file, whatever the grid of the G-buffer.
struct FoundCamera {
  Camera camera, position_camera;
  bool world_given = false;  ///< --camera or the header gave the pose, and so the world
  /// If the header gave the pose and P cannot prove it: the reading used, then the other readings
  /// that normals may decide for.
  std::vector<HeaderCamera> readings = {};
};

}  // namespace ssdo
