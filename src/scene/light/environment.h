// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
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
  /// The same radiance from everywhere; `up` tells which way surfaces are likely to go on that the
  /// frame does not show.
  static Environment constant(const glm::vec3& radiance, UpAxis up = UpAxis::y);

  /// A lat-long map of finite values, two to one or not.
  Environment(std::shared_ptr<const Plane<glm::vec3>> lat_long, const EnvironmentFrame& frame);

  /// A piece of sky: where its light comes from, and its radiance times its solid angle.
  struct Patch {
    glm::vec3 direction{0}, power{0};
    float solid_angle = 0;
  };

  bool is_constant() const { return !map_; }
  const glm::vec3& constant_radiance() const { return constant_; }
  const EnvironmentFrame& frame() const { return frame_; }

  /// The texels before the exposure; null for a constant.
  const std::shared_ptr<const Plane<glm::vec3>>& map() const { return map_; }

  /// What turns a texel into radiance.
  float gain() const { return gain_; }

  /// World direction of a texel's centre, and the place of a unit direction in the map, in texels
  /// with centres at halves.
  glm::vec3 texel_direction(int x, int y) const;
  glm::vec2 texel_at(const glm::vec3& direction_world) const;

  /// Angle around the up axis at a place in columns, centres at halves. The direction at an angle p
  /// to the up axis is axes() * (sin p cos azimuth, sin p sin azimuth, cos p).
  float azimuth_at(float column) const;
  glm::mat3 axes() const;

  /// Steradians of a texel in row `y`.
  float texel_solid_angle(int y) const;

  /// Bilinear radiance from a unit direction in world space.
  glm::vec3 radiance(const glm::vec3& direction_world) const;

  /// Mean over the sphere.
  glm::vec3 mean() const;

  /// The map averaged over a lobe about every direction, for directions in camera space. The lobe
  /// falls linearly in the cosine and has the weight of a cone of `solid_angle` steradians.
  OctahedralMap blurred(float solid_angle, const glm::mat3& world_to_camera) const;

  /// The map in at most columns x columns / 2 blocks of texels, in camera space, row by row. A
  /// block's direction is the mean over its light, so that a sun of one texel keeps its place and
  /// its irradiance. Not for a constant.
  std::vector<Patch> patches(const glm::mat3& world_to_camera, int columns) const;

 private:
  Environment() = default;

  /// World direction from the angle to the up axis and the one around it.
  glm::vec3 direction_at(float polar, float azimuth) const;

  std::shared_ptr<const Plane<glm::vec3>> map_;
  EnvironmentFrame frame_;
  float gain_ = 1;  ///< from the exposure
  glm::vec3 constant_{0};
};

}  // namespace ssdo
