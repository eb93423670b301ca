// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "scene/light/lamps/cone.h"
#include "scene/light/source.h"

namespace ssdo {

/// A receiver in the space of a lamp, in units of its size: the middle of the lamp at the origin,
/// its axis along z. All that shapes do is in this space.
struct LampReceiver {
  glm::dvec3 position{0}, normal{0};
};

/// A direction in which a receiver sees a lamp.
struct LampSample {
  glm::dvec3 to{0};
  double distance = 0;
  double solid_angle = 0;  ///< of the lamp, if its points were everywhere as dense as here
};

/// Receivers nearer to the plane of a flat lamp see its points as from this far away.
constexpr double kNearestToPlane = 1e-9;

/// Beyond this distance, points of a rect are uniform over its area: floats lose the angles of its
/// corners, and the light of its points differs by a quarter at most.
constexpr double kFarFromRect = 8;

/// Angles about the axis: from `middle - half` to `middle + half`.
struct LampArc {
  double middle = 0, half = 0;
};

/// Angles off the axis, 0 to pi, at which the parts of a lamp that are seen change their shape, in
/// any order: the first and the last, and those of corners.
struct LampBreakpoints {
  std::array<double, 13> angles;
  int count = 0;

  void add(double angle) { angles[std::size_t(count++)] = angle; }
};

/// The parts of a lamp that a receiver sees at one angle off its axis: arcs of a circle about the
/// opposite direction.
struct LampArcs {
  std::array<LampArc, 4> arcs;
  int count = 0;
};

enum class LampShape { sphere, disk, rect };

/// A lamp with a place and a size. `irradiance` is its radiance times the area that it shows, over
/// pi: a sphere shows a disk of its radius, a flat lamp all of its area. received() is the integral
/// of the cosine over the directions in which the lamp is seen, divided by this area: far in front
/// of the lamp, cos / distance^2.
///
/// Points are spread by solid angle, so that near lamps have no points that are much brighter than
/// others: point() is a place of the unit disk or square, which seen() maps onto the lamp for each
/// receiver.
struct LocalLamp : Source {
  const LampShape shape;
  glm::vec3 center{0};
  glm::mat3 axes{1};   ///< orthogonal columns: along the width, along the height, to where it sends
  double size = 1;     ///< the unit: a radius, or half of the longer side
  double nearest = 0;  ///< receivers nearer than this get no more light than there
  glm::dvec2 half_sides{1};     ///< sides of a rect over 2, the longer one 1
  bool faces_receiver = false;  ///< a sphere is the disk across it that faces each receiver
  Cone spot_cone;               ///< where it sends

  float received(const glm::vec3& position, const glm::vec3& normal) const override;
  glm::vec3 point(const glm::vec2& u) const override;
  SourcePoint seen(const glm::vec3& position, const glm::vec3& point) const override;
  SourceCone cone(const glm::vec3& position) const override;
  const LocalLamp* local_lamp() const override { return this; }

  virtual double shown_area() const = 0;
  virtual double reach() const = 0;  ///< of its farthest point from the middle

 protected:
  explicit LocalLamp(LampShape of) : shape(of) {}

  /// Integral of max(0, cos) over the directions in which the lamp is seen.
  virtual double integral(const LampReceiver& r) const = 0;
  virtual LampSample sample(const glm::dvec3& position, const glm::dvec2& point) const = 0;

  virtual LampBreakpoints breakpoints(const glm::dvec3& position) const = 0;
  virtual LampArcs arcs(const glm::dvec3& position, double off_axis) const = 0;

 private:
  LampReceiver local(const glm::vec3& position, const glm::vec3& normal) const;
  double within_cone(const LampReceiver& r) const;
  double dimming(double distance) const;
};

}  // namespace ssdo
