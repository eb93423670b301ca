// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace ssdo {

/// The piece of surface that a pixel shows, in camera space. Half a cache line: a sample that lands
/// anywhere in the frame costs one.
struct alignas(32) Surfel {
  glm::vec3 position{0};
  float valid = 0;      ///< 1 on a surface, 0 on background and broken pixels; read by vectors
  glm::vec3 normal{0};  ///< unit, on the viewer's side
  float rounding = 0;   ///< distance by which the rounding of P as stored may have moved it
  static constexpr float kBroken = -1;  ///< as `rounding`, where valid is 0 and is_broken() holds

  /// Whether there is a surface.
  bool is_surface() const { return valid != 0; }

  /// Whether something is there that P does not place: it is not finite, or behind the camera.
  bool is_broken() const { return rounding < 0; }

  /// Whether methods can work with it: a surface in front of the viewer, whose position has a
  /// square with room for sums, with a normal of about unit length. Methods take all else for
  /// background.
  bool is_usable() const {
    constexpr float kNearest = 1e-15f, kFarthest2 = 1e30f;
    // Not-a-number is neither below nor above anything.
    return is_surface() && position.z < -kNearest && glm::dot(position, position) < kFarthest2 &&
           glm::dot(normal, normal) > 0.5f && glm::dot(normal, normal) < 2 &&
           rounding * rounding < kFarthest2;
  }
};
static_assert(sizeof(Surfel) == 32);

}  // namespace ssdo
