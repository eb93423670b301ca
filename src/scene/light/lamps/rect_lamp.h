// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/geometric.hpp>

#include "scene/light/lamps/near_lamp.h"

namespace ssdo {

/// A rectangle that sends the same radiance from all of its front; `size` is half of its longer
/// side.
struct RectLamp final : NearLamp {
  glm::dvec2 half{1};  ///< of its width and height; the longer one is 1

 protected:
  double integral(const LampReceiver& r) const override;
  double shown_area() const override { return 4 * half.x * half.y; }
  double reach() const override { return glm::length(half); }
  LampSample sample(const glm::dvec3& position, const glm::vec2& u) const override;
  std::vector<double> bends(const glm::dvec3& position) const override;
  LampArcs arcs(const glm::dvec3& position, double off_axis) const override;
};

}  // namespace ssdo
