// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <vector>

#include "estimators/triangle_rays.h"
#include "scene/other_views/other_surfaces.h"

namespace ssdo {

/// Triangles of other views that answer rays in the camera space of the frame, through Embree.
/// May be asked from many threads at once.
class OtherViewRays {
 public:
  /// `vertices` must outlive this. Errors: ExitCode::failed where memory does not suffice.
  OtherViewRays(const std::vector<Vertex>& vertices,
                const std::vector<OtherSurfaces::Triangle>& triangles);

  /// The triangles of surfaces that the frame does not show; null: there are none.
  static std::unique_ptr<OtherViewRays> of_added(const OtherSurfaces& surfaces);

  /// The surface that a ray meets first.
  struct Hit {
    int sender = -1;      ///< the vertex whose light it sends; -1: nothing is met
    bool unseen = false;  ///< the ray comes from the side that no view has seen
    float distance = std::numeric_limits<float>::infinity();
  };

  // Directions are unit vectors; a reach may be infinite.

  bool is_blocked(const glm::vec3& origin, const glm::vec3& direction, float reach) const;
  Hit first_hit(const glm::vec3& origin, const glm::vec3& direction, float reach) const;

 private:
  class OtherThings;
  const std::vector<Vertex>& vertices_;
  TriangleRays rays_;
};

}  // namespace ssdo
