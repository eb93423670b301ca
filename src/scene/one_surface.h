// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "scene/camera/camera.h"

namespace ssdo {

/// Width of what a pixel shows, in scene units.
class PixelFootprint {
 public:
  explicit PixelFootprint(const Camera& camera)
      : orthographic_(camera.orthographic), per_depth_(float(1 / std::min(camera.fx, camera.fy))) {}

  /// Of a surface at this depth along the axis that faces the viewer.
  float at(float depth) const { return orthographic_ ? per_depth_ : depth * per_depth_; }

 private:
  bool orthographic_;
  float per_depth_;
};

/// A point of a surface in camera space, and the unit normal there.
struct SurfacePoint {
  glm::vec3 position, normal;
};

/// Neighbours are on one surface when neither lies farther than this from the other's tangent
/// plane, in pixel footprints.
constexpr float kSurfaceGap = 4;

/// Whether what two neighbouring pixels show belongs to one surface.
inline bool on_one_surface(const SurfacePoint& a, const SurfacePoint& b,
                           const PixelFootprint& footprint) {
  const glm::vec3 step = b.position - a.position;
  const float gap =
      std::max(std::abs(glm::dot(step, a.normal)), std::abs(glm::dot(step, b.normal)));
  return gap <= kSurfaceGap * footprint.at(std::min(-a.position.z, -b.position.z));
}

}  // namespace ssdo
