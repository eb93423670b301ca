// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "math/plane.h"

namespace ssdo {

/// Where the light of a source lies: texels of a part of a lat-long map, each with its share.
class SunShape {
 public:
  /// Where the part of the map lies. A direction at the polar angle p and the azimuth a is
  /// axes * (sin p cos a, sin p sin a, cos p). Angles in radians.
  struct Place {
    glm::mat3 axes{1};
    float polar = 0, row_angle = 0;  ///< of the upper edge, and from row to row
    float azimuth = 0, column_angle = 0;
  };

  SunShape() = default;

  /// `light` is what each texel adds to the irradiance, in any unit, 0 or more; not all are 0.
  SunShape(const Place& place, const Plane<float>& light);

  /// Unit direction to a point of the source. Uniform `u` in the unit square give points in
  /// proportion to the light: u.y gives the row, u.x the place along it, uniformly within a texel.
  glm::vec3 point(const glm::vec2& u) const;

  void turn(const glm::mat3& by) { place_.axes = by * place_.axes; }

 private:
  Place place_;
  std::vector<float> rows_;  ///< light in the rows before each edge, of all light: 0..1
  Plane<float> columns_;     ///< the same along every row
};

}  // namespace ssdo
