// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "math/plane.h"
#include "scene/camera/camera.h"
#include "scene/geometry.h"
#include "scene/surfel.h"
#include "scene/view.h"

namespace ssdo {

/// What another camera shows of the scene, or a panorama, in the camera space of the frame.
struct FurtherView {
  std::string file;
  Camera camera;            ///< from the frame's camera space to its own
  Window window;            ///< of the planes, in the pixels of its display window
  bool closed = false;      ///< a panorama whose last column lies beside its first
  Plane<Surfel> surfel;     ///< normals are on the side of its own camera
  Plane<float> depth;       ///< Camera::depth_of; infinite where there is no surface
  Plane<glm::vec3> albedo;  ///< empty where the file has none
  std::vector<std::string> warnings;

  /// Width of what a pixel at this depth shows, in scene units.
  float footprint(float at_depth) const {
    return (camera.orthographic ? 1.0f : at_depth) / float(std::min(camera.fx, camera.fy));
  }
};

/// Reads a G-buffer of the same scene by the stages of any view. Its layers are found by their
/// names, and its camera is fitted from its P, which has to be in world space as that of the frame
/// is. Errors: those of the stages; ExitCode::layer where P is missing or in camera space, and
/// where no camera explains it.
FurtherView read_further_view(const std::string& file, const Geometry& frame);

}  // namespace ssdo
