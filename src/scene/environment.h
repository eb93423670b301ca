// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "math/octahedral_map.h"
#include "math/plane.h"

namespace ssdo {

/// Which way is up in the world of P and N, and so how a lat-long map lies around it.
///   y  OpenEXR's axes: longitude = atan2(x, z), latitude = asin(y)
///   z  Blender's: u = 1/2 - atan2(y, x) / 2 pi, v from the top = acos(z) / pi
enum class UpAxis { y, z };

/// How a map is turned and scaled before it lights the scene.
struct EnvironmentFrame {
  UpAxis up = UpAxis::y;
  float rotate_degrees = 0;  ///< about the up axis, counter-clockwise seen from above
  float exposure_stops = 0;
};

/// Light from infinitely far away: one colour, or a lat-long map whose outer pixel edges are the
/// date line and the poles. Radiance is scene-linear.
class Environment {
 public:
  /// The same radiance from everywhere.
  static Environment constant(const glm::vec3& radiance);

  /// A lat-long map of finite values, two to one or not.
  Environment(std::shared_ptr<const Plane<glm::vec3>> lat_long, const EnvironmentFrame& frame);

  bool is_constant() const { return !map_; }
  const glm::vec3& constant_radiance() const { return constant_; }
  const EnvironmentFrame& frame() const { return frame_; }

  /// Bilinear radiance from a unit direction in world space.
  glm::vec3 radiance(const glm::vec3& direction_world) const;

  /// Mean over the sphere.
  glm::vec3 mean() const;

  /// The map averaged over a lobe about every direction, for directions in camera space. The lobe
  /// falls linearly in the cosine and has the weight of a cone of `solid_angle` steradians.
  OctahedralMap blurred(float solid_angle, const glm::mat3& world_to_camera) const;

 private:
  /// A piece of sky: where its light comes from, and its radiance times its solid angle.
  struct Patch {
    glm::vec3 direction{0}, power{0};
    float solid_angle = 0;
  };

  Environment() = default;
  std::vector<Patch> patches(const glm::mat3& world_to_camera) const;

  /// World direction at a place of the map, u and v in 0..1 from the upper left corner.
  glm::vec3 direction_at(float u, float v) const;

  std::shared_ptr<const Plane<glm::vec3>> map_;
  EnvironmentFrame frame_;
  float gain_ = 1;  ///< from the exposure
  glm::vec3 constant_{0};
};

}  // namespace ssdo
