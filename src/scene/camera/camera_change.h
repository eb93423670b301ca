// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "scene/camera/camera.h"

namespace ssdo {

/// From the camera space of one frame to that of another, and into its picture. A rotation and the
/// camera's own step stay exact however far away the world's origin is.
struct CameraChange {
  CameraChange(const Camera& from, const Camera& other)
      : turn(other.rotation * glm::transpose(from.rotation)),
        step(other.rotation * (from.origin - other.origin)),
        to(other) {}

  glm::dvec3 position(const glm::vec3& p) const { return turn * glm::dvec3(p) + step; }
  glm::dvec3 direction(const glm::vec3& v) const { return turn * glm::dvec3(v); }

  /// Projects a position in the space of the other camera to pixels of the display window; not
  /// finite behind that camera.
  glm::dvec2 place(const glm::dvec3& there) const {
    return to.orthographic || there.z < 0 ? to.project(there) : glm::dvec2(NAN);
  }

  glm::dmat3 turn;
  glm::dvec3 step;
  Camera to;
};

}  // namespace ssdo
