// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <glm/geometric.hpp>

#include "scene/light/source.h"

namespace ssdo::test {

/// A point that light leaves from, all around alike: the least of what a lamp is.
struct PointSource final : Source {
  glm::vec3 place;

  explicit PointSource(const glm::vec3& at, const glm::vec3& light = glm::vec3(1)) : place(at) {
    irradiance = light;
  }

  float received(const glm::vec3& position, const glm::vec3& normal) const override {
    const SourcePoint point = seen(position, place);
    return point.weight * std::max(0.0f, glm::dot(point.to, normal));
  }
  glm::vec3 point(const glm::vec2&) const override { return place; }
  SourcePoint seen(const glm::vec3& position, const glm::vec3& point) const override {
    const float distance = glm::distance(position, point);
    return {(point - position) / distance, distance, 1 / (distance * distance)};
  }
  SourceCone cone(const glm::vec3& position) const override {
    const SourcePoint point = seen(position, place);
    return {point.to, point.distance, 0};
  }
};

}  // namespace ssdo::test
