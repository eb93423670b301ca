// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <limits>

#include "estimators/trace/height_field.h"
#include "estimators/triangle_rays.h"

namespace ssdo {

/// A height field that answers rays in camera space, through Embree. May be asked from many threads
/// at once.
class RayScene {
 public:
  /// Errors: ExitCode::failed where memory does not suffice.
  explicit RayScene(HeightField field);

  // Directions are unit vectors; a reach may be infinite. The sides and back of a solid count only
  // if its front is within reach too, because the depth of a distant thing is not known.

  /// Whether a ray meets anything.
  bool is_blocked(const glm::dvec3& origin, const glm::dvec3& direction, double reach) const;

  /// The surface that a ray meets first.
  struct Hit {
    Owner owner;  ///< sender -1 for nothing, and for what sends nothing
    double distance = std::numeric_limits<double>::infinity();
  };
  Hit first_hit(const glm::dvec3& origin, const glm::dvec3& direction, double reach) const;

 private:
  class FrontsWithin;
  HeightField field_;
  TriangleRays rays_;
};

}  // namespace ssdo
