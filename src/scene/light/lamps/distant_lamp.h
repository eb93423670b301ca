// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <glm/geometric.hpp>

#include "scene/light/lamps/cap.h"
#include "scene/light/source.h"

namespace ssdo {

/// A round even patch of the sky. received() is 1 for a surface that faces one of at most half of
/// the sky.
struct DistantLamp final : Source {
  glm::vec3 direction{0};  ///< unit, towards its middle
  Cap cap;

  float received(const glm::vec3&, const glm::vec3& normal) const override {
    const double middle = glm::dot(normal, direction);
    return float(cap.cosine >= 0 ? mean_cosine_of_small_cap(middle, cap)
                                 : form_factor_of_cap(middle, cap) / form_factor_of_cap(1, cap));
  }
  glm::vec3 point(const glm::vec2& u) const override {
    return glm::vec3(frame_of(glm::dvec3(direction)) * direction_in_cap(cap.height(), u));
  }
  SourcePoint seen(const glm::vec3&, const glm::vec3& point) const override {
    const double weight =
        cap.cosine >= 0 ? 2 / (1 + cap.cosine) : 2 * cap.height() / form_factor_of_cap(1, cap);
    return {.to = point, .weight = float(weight)};
  }
  SourceCone cone(const glm::vec3&) const override {
    return {.to = direction, .angular_radius = float(std::atan2(cap.sine, cap.cosine))};
  }
};

}  // namespace ssdo
