// SPDX-License-Identifier: Apache-2.0
//
// What a lamp gives, slowly: a sum over rays that may meet it, in double.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/mat3x3.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <random>

#include "scene/light/lamps/lamp.h"

namespace ssdo::test {

inline glm::dvec3 random_unit(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dvec3{normal(random), normal(random), normal(random)});
}

inline double between(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// Columns, orthogonal, of which the last is `n`.
inline glm::dmat3 about(const glm::dvec3& n) {
  const glm::dvec3 other = std::abs(n.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(other, n));
  return {x, glm::cross(n, x), n};
}

/// The share of the light of a cone that a lamp sends into a direction: UsdLux's shaping, or
/// Blender's fade.
inline double share_of_cone(const Lamp& lamp, const glm::dvec3& sent) {
  if (!lamp.has_cone) return 1;
  const double off = std::acos(std::clamp(glm::dot(sent, -lamp.axes[2]), -1.0, 1.0));
  const double cutoff = glm::radians(lamp.cone_angle), start = cutoff * (1 - lamp.cone_softness);
  if (off > cutoff) return 0;
  if (off <= start) return 1;
  const double t = lamp.cone_by_cosine
                       ? (std::cos(start) - std::cos(off)) / (std::cos(start) - std::cos(cutoff))
                       : (off - start) / (cutoff - start);
  return 1 - t * t * (3 - 2 * t);
}

/// What arrives along a ray from `from`, for a radiance of 1.
inline double radiance_along(const Lamp& lamp, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 p = from - lamp.position;
  if (lamp.type == LampType::distant)
    return glm::dot(to, lamp.axes[2]) > std::cos(glm::radians(lamp.angle / 2)) ? 1 : 0;
  if (lamp.type == LampType::sphere) {
    if (lamp.soft_falloff) {
      const double slope = glm::dot(to, -glm::normalize(p));
      return slope > 1 / std::hypot(1, lamp.radius / glm::length(p)) ? share_of_cone(lamp, -to) : 0;
    }
    const double along = glm::dot(p, to), across = glm::dot(p, p) - along * along;
    return along < 0 && across < lamp.radius * lamp.radius ? share_of_cone(lamp, -to) : 0;
  }
  const double height = glm::dot(p, -lamp.axes[2]), slope = glm::dot(to, lamp.axes[2]);
  if (!(height > 0 && slope > 0)) return 0;
  const glm::dvec3 hit = p + to * (height / slope);
  const double x = glm::dot(hit, lamp.axes[0]), y = glm::dot(hit, lamp.axes[1]);
  const bool meets = lamp.type == LampType::disk
                         ? x * x + y * y < lamp.radius * lamp.radius
                         : std::abs(x) < lamp.width / 2 && std::abs(y) < lamp.height / 2;
  return meets ? share_of_cone(lamp, -to) : 0;
}

/// Radius of a ball about a lamp.
inline double reach_of(const Lamp& lamp) {
  return lamp.type == LampType::rect ? std::hypot(lamp.width, lamp.height) / 2 : lamp.radius;
}

/// Irradiance over pi for a radiance of 1, by side * side rays over a cap that holds the lamp.
inline double slow_sum(const Lamp& lamp, const glm::dvec3& position, const glm::dvec3& normal,
                       int side) {
  const glm::dvec3 way = lamp.position - position;
  const bool is_distant = lamp.type == LampType::distant;
  const double distance = glm::length(way), reach = reach_of(lamp);
  double height = 2;  // of the whole sphere
  if (is_distant)
    height = 1 - std::cos(glm::radians(lamp.angle / 2));
  else if (distance > reach)
    height = 2 * std::pow(std::sin(std::asin(reach / distance) / 2), 2);
  const glm::dmat3 frame = about(is_distant ? lamp.axes[2] : way / distance);
  double sum = 0;
  for (int row = 0; row < side; ++row) {
    const double down = height * (row + 0.5) / side, out = std::sqrt(down * (2 - down));
    for (int column = 0; column < side; ++column) {
      // The golden ratio keeps columns of rows from meeting edges together.
      const double turn = (column + std::fmod(row * 0.61803398875, 1)) / side;
      const double angle = 2 * glm::pi<double>() * turn;
      const glm::dvec3 to =
          frame * glm::dvec3(out * std::cos(angle), out * std::sin(angle), 1 - down);
      const double cosine = glm::dot(to, normal);
      if (cosine > 0) sum += cosine * radiance_along(lamp, position, to);
    }
  }
  return sum * 2 * height / (double(side) * side);
}

}  // namespace ssdo::test
