// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/geometric.hpp>

#include "scene/light/lamps/local_lamp.h"

namespace ssdo {

/// A rectangle that sends the same radiance from all of its front; `size` is half of its longer
/// side.
struct RectLamp final : LocalLamp {
  RectLamp() : LocalLamp(LampShape::rect) {}

  double shown_area() const override { return 4 * half_sides.x * half_sides.y; }
  double reach() const override { return glm::length(half_sides); }

 protected:
  double integral(const LampReceiver& r) const override;
  LampSample sample(const glm::dvec3& position, const glm::dvec2& point) const override;
  LampBreakpoints breakpoints(const glm::dvec3& position) const override;
  LampArcs arcs(const glm::dvec3& position, double off_axis) const override;
};

}  // namespace ssdo
