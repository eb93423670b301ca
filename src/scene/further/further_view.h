// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <glm/vec3.hpp>
#include <limits>

#include "math/plane.h"
#include "scene/camera/camera.h"
#include "scene/further/further_pictures.h"
#include "scene/geometry.h"
#include "scene/surfel.h"

namespace ssdo {

/// What a further view knows about a point.
enum class Sight {
  unknown,  ///< outside of its picture, or behind what it shows
  surface,  ///< it shows a surface there
  empty,    ///< it looks through
};

/// A further picture, placed in the camera space of a frame. What does not depend on the frame
/// stays in the picture, which all frames share.
struct FurtherView {
  FurtherPictures::Picture picture;
  Camera camera;              ///< from the frame's camera space to its own
  bool is_neighbour = false;  ///< of the frame's own sequence

  const std::string& file = picture->file;
  const Window& window = picture->window;
  const bool& closed = picture->closed;
  const Plane<Surfel>& surfel = picture->surfel;  ///< in its own camera space
  const Plane<float>& depth = picture->depth;
  const Plane<glm::vec3>& albedo = picture->albedo;

  /// Its surfels in the camera space of the frame.
  Plane<Surfel> surfels_in_frame() const;

  /// Width of what a pixel at this depth shows, in scene units.
  float footprint(float at_depth) const {
    return (camera.orthographic ? 1.0f : at_depth) / float(std::min(camera.fx, camera.fy));
  }

  /// What the four pixels around the picture of a point agree on. A view does not show what is
  /// narrower than a few of its pixels but looks past it: `width` is that of what the point would
  /// be in, in scene units.
  Sight look(const glm::vec3& point, float width = std::numeric_limits<float>::infinity()) const;
};

/// Places a picture in the camera space of a frame whose world is known.
FurtherView place(FurtherPictures::Picture picture, const Geometry& frame);

}  // namespace ssdo
