// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "scene/light/lamps/cap.h"
#include "scene/light/source.h"

namespace ssdo {

/// A round patch of the sky of the same radiance everywhere. received() is 1 for a surface that
/// faces its middle.
struct DistantLamp final : Source {
  glm::vec3 direction{0};  ///< unit, towards its middle
  Cap cap;

  float weight() const {
    return float(cap.cosine >= 0 ? 2 / (1 + cap.cosine)
                                 : 2 * cap.height() / form_factor_of_cap(1, cap));
  }
  float angular_radius() const {
    return cap.cosine > 0 ? std::asin(float(cap.sine)) : std::numbers::pi_v<float> / 2;
  }

  float received(const glm::vec3&, const glm::vec3& normal) const override {
    const double middle = glm::dot(normal, direction);
    return float(cap.cosine >= 0 ? mean_cosine_of_small_cap(middle, cap)
                                 : form_factor_of_cap(middle, cap) / form_factor_of_cap(1, cap));
  }
  glm::vec3 point(const glm::vec2& u) const override {
    return glm::vec3(frame_of(glm::dvec3(direction)) * direction_in_cap(cap.height(), to_disk(u)));
  }
  SourcePoint seen(const glm::vec3&, const glm::vec3& point) const override {
    return {.to = point, .weight = weight()};
  }
  SourceCone cone(const glm::vec3&) const override {
    return {.to = direction, .angular_radius = angular_radius()};
  }
  const DistantLamp* distant_lamp() const override { return this; }
};

}  // namespace ssdo
