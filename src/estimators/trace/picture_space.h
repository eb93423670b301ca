// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "estimators/triangle_rays.h"
#include "scene/geometry.h"

namespace ssdo {

/// Pixels from the principal point to the right and down, and a height h that falls away from the
/// viewer: proportional to 1 / depth, or to minus the depth in parallel views, so that a slope of
/// one pixel per pixel is 45 degrees about at the mean depth. Straight lines and planes stay what
/// they are, view rays become parallel to the axis of h, and endless walls end at h = 0.
class PictureSpace {
 public:
  explicit PictureSpace(const Geometry& geometry);

  /// A ray from here as far as `reach`, in lengths of the direction.
  using Ray = TriangleRays::Ray;

  glm::vec3 point(const glm::dvec3& camera_space) const;
  glm::vec3 position(const glm::vec3& point) const;  ///< the inverse
  Ray ray(const glm::dvec3& origin, const glm::dvec3& direction, double reach) const;

  /// How h changes along the tangent plane at `p` with the normal `n`, per pixel.
  glm::vec2 slope(const glm::vec3& p, const glm::vec3& n) const;

  /// The height of what lies a length behind `p`, whose height is h, along the view ray.
  float height_behind(float h, const glm::vec3& p, float length) const;

  bool orthographic() const { return orthographic_; }

 private:
  bool orthographic_;
  double fx_, fy_, scale_;
  double endless_;  ///< lowest height of parallel views
};

}  // namespace ssdo
