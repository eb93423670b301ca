// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/light/lamps/local_lamp.h"

namespace ssdo {

/// A ball that sends the same radiance from all of its surface; `size` is its radius. A receiver
/// inside sees it in the directions of Cap::of_ball(). With LocalLamp::faces_receiver, it is
/// instead a disk of that radius which faces every receiver.
struct SphereLamp final : LocalLamp {
  SphereLamp() : LocalLamp(LampShape::sphere) {}

  double shown_area() const override;
  double reach() const override { return 1; }

 protected:
  double integral(const LampReceiver& r) const override;
  LampSample sample(const glm::dvec3& position, const glm::dvec2& point) const override;
  LampBreakpoints breakpoints(const glm::dvec3& position) const override;
  LampArcs arcs(const glm::dvec3& position, double off_axis) const override;
};

}  // namespace ssdo
