// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "scene/light/source.h"
#include "scene/light/sun_shape.h"

namespace ssdo {

/// A source of any shape that is endlessly far, taken out of an environment: the sun, a lamp, a
/// window. received() is 1 for a normal that is `direction`: `irradiance` is the length of the
/// vector sum of its light.
struct DistantSource final : Source {
  glm::vec3 direction{0};  ///< unit, towards its middle: that of the vector sum of its light
  float angular_radius =
      0;                ///< radians, from the middle to its farthest light; half a texel or more
  glm::vec2 extent{0};  ///< radians, sides of the even rectangle with its moments, longer one first
  float share = 0;      ///< of the irradiance that a surface facing it has from everywhere

  SunShape shape;

  /// Centres of parts of equal light, scaled so that their mean is `direction`, and half the width
  /// of such a part in radians.
  std::vector<glm::vec3> points;
  float point_radius = 0;

  glm::vec3 point(const glm::vec2& u) const override { return shape.point(u); }

  /// dot(normal, direction) if all of it is above the horizon.
  float received(const glm::vec3&, const glm::vec3& normal) const override {
    const float middle = glm::dot(normal, direction), edge = std::sin(angular_radius);
    if (middle >= edge) return middle;
    return middle <= -edge ? 0 : cosine_at_horizon(normal);
  }

  SourcePoint seen(const glm::vec3&, const glm::vec3& point) const override { return {point}; }
  SourceCone cone(const glm::vec3&) const override {
    return {.to = direction, .angular_radius = angular_radius};
  }
  const DistantSource* distant() const override { return this; }

  void turn(const glm::mat3& by);

 private:
  float cosine_at_horizon(const glm::vec3& normal) const;
};

/// Fills in `points` and `point_radius` of a source that has all the rest.
void set_points(DistantSource& sun);

/// The mean of max(0, x) over the numbers x that are `radius` from `middle` at most: the cosine to
/// a part of a source, which the horizon may cut.
inline float mean_above_horizon(float middle, float radius) {
  const float cut = std::max(0.0f, radius - std::abs(middle));
  return std::max(0.0f, middle) + cut * cut / (4 * radius);
}

/// How bright a colour is whatever its space: the mean of its channels.
inline float brightness(const glm::vec3& c) { return (c.x + c.y + c.z) / 3; }

}  // namespace ssdo
