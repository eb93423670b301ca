// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <glm/trigonometric.hpp>
#include <memory>
#include <random>
#include <vector>

#include "scene/light/environment.h"

namespace ssdo::test {

using Radiance = std::function<glm::vec3(const glm::vec3&)>;

/// A map of `radiance` averaged over samples x samples places of every texel.
inline Environment paint(int width, const Radiance& radiance, int samples = 1,
                         float rotate_degrees = 0, UpAxis up = UpAxis::z) {
  auto map = std::make_shared<Plane<glm::vec3>>(width, width / 2, glm::vec3(0));
  const auto fine = std::make_shared<Plane<glm::vec3>>(width * samples, width / 2 * samples);
  const Environment places(fine, {.up = up});
  for (int y = 0; y < fine->height; ++y) {
    for (int x = 0; x < fine->width; ++x) {
      (*map)(x / samples, y / samples) +=
          radiance(places.texel_direction(x, y)) / float(samples * samples);
    }
  }
  return Environment(map, {.up = up, .rotate_degrees = rotate_degrees});
}

inline glm::vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  return glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
}

/// At an azimuth and an elevation in degrees, z up.
inline glm::vec3 direction_of(float azimuth, float elevation) {
  const float a = glm::radians(azimuth), e = glm::radians(elevation);
  return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
}

/// Whether a direction is in a disc; angles in degrees.
inline bool in_disc(const glm::vec3& d, const glm::vec3& middle, float radius) {
  return glm::dot(d, middle) > std::cos(glm::radians(radius));
}

/// Whether it is in a rectangle in the plane before its middle, so many degrees wide and high.
inline bool in_rectangle(const glm::vec3& d, const glm::vec3& middle, float wide, float high) {
  const glm::vec3 right = glm::normalize(glm::cross({0, 0, 1}, middle)),
                  up = glm::cross(middle, right);
  const float ahead = glm::dot(d, middle);
  return ahead > 0 && std::abs(glm::dot(d, right)) < ahead * std::tan(glm::radians(wide / 2)) &&
         std::abs(glm::dot(d, up)) < ahead * std::tan(glm::radians(high / 2));
}

/// Unoccluded irradiance over pi, texel by texel.
class TexelSum {
 public:
  explicit TexelSum(const Environment& map) {
    for (int y = 0; y < map.map()->height; ++y) {
      for (int x = 0; x < map.map()->width; ++x) {
        const glm::dvec3 power(map.gain() * map.texel_solid_angle(y) * (*map.map())(x, y));
        texels_.push_back({glm::dvec3(map.texel_direction(x, y)), power / glm::pi<double>()});
      }
    }
  }
  glm::dvec3 operator()(const glm::dvec3& normal) const {
    glm::dvec3 sum(0);
    for (const Texel& t : texels_) sum += std::max(0.0, glm::dot(normal, t.direction)) * t.light;
    return sum;
  }

 private:
  struct Texel {
    glm::dvec3 direction, light;
  };
  std::vector<Texel> texels_;
};

}  // namespace ssdo::test
