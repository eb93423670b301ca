// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <limits>
#include <string>
#include <vector>

#include "math/plane.h"
#include "scene/camera/camera.h"
#include "scene/geometry.h"
#include "scene/surfel.h"

namespace ssdo {

/// What a further view knows about a point.
enum class Sight {
  unknown,  ///< outside of its picture, or behind what it shows
  surface,  ///< it shows a surface there
  empty,    ///< it looks through
};

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

  /// What the four pixels around the picture of a point agree on. A view does not show what is
  /// narrower than a few of its pixels but looks past it: `width` is that of what the point would
  /// be in, in scene units.
  Sight look(const glm::vec3& point, float width = std::numeric_limits<float>::infinity()) const;
};

/// Reads a G-buffer of the same scene by the stages of any view. Its layers are found by their
/// names, and its camera is fitted from its P, which has to be in world space as that of the frame
/// is. Errors: those of the stages; ExitCode::layer where P is missing or in camera space, and
/// where no camera explains it.
FurtherView read_further_view(const std::string& file, const Geometry& frame);

}  // namespace ssdo
