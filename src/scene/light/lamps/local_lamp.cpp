// SPDX-License-Identifier: Apache-2.0
//
// A lamp with a cone sends less in directions off its axis. What it gives is an integral over the
// angle t off the axis and the angle a about it,
//
//   integral of share(t) sin t (integral of max(0, n_z cos t + n_t sin t cos(a - a_n)) da) dt
//
// The inner integral is exact: the angles a at which the lamp is seen above the horizon of the
// receiver form a few arcs. The outer integral is by Gauss's quadrature between the angles at which
// the arcs change their shape. The arcs open there as square roots, which a substitution by sin
// takes away.
#include "scene/light/lamps/local_lamp.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "math/pi.h"
#include "scene/light/lamps/cap.h"

namespace ssdo {
namespace {

/// Gauss and Legendre's nodes and weights on -1..1.
constexpr int kNodes = 8;
constexpr std::array<double, kNodes> kPlaces = {
    -0.9602898564975363, -0.7966664774136267, -0.5255324099163290, -0.1834346424956498,
    0.1834346424956498,  0.5255324099163290,  0.7966664774136267,  0.9602898564975363};
constexpr std::array<double, kNodes> kWeights = {
    0.1012285362903763, 0.2223810344533745, 0.3137066458778873, 0.3626837833783620,
    0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};

/// Integral of along + across cos(a - towards) over the part of an arc where that is positive.
double cosine_over(const LampArc& arc, double along, double across, double towards) {
  if (along <= -across) return 0;
  const double open = along >= across ? kPi : std::acos(-along / across);
  // In angles from `towards`, where the open part repeats every 2 pi.
  const double middle = std::remainder(arc.middle - towards, 2 * kPi);
  double sum = 0;
  for (const double turn : {-2 * kPi, 0.0, 2 * kPi}) {
    const double from = std::max(middle - arc.half, turn - open),
                 to = std::min(middle + arc.half, turn + open);
    if (to > from) sum += along * (to - from) + across * (std::sin(to) - std::sin(from));
  }
  return sum;
}

}  // namespace

LampReceiver LocalLamp::local(const glm::vec3& position, const glm::vec3& normal) const {
  const glm::dmat3 turn(axes);
  return {(glm::dvec3(position) - glm::dvec3(center)) * turn / size, glm::dvec3(normal) * turn};
}

double LocalLamp::dimming(double distance) const {
  const double counts = std::max(distance, 1.0) * size;
  return counts < nearest ? counts * counts / (nearest * nearest) : 1;
}

float LocalLamp::received(const glm::vec3& position, const glm::vec3& normal) const {
  const LampReceiver r = local(position, normal);
  const double found = spot_cone.is_open() ? integral(r) : within_cone(r);
  return float(std::max(0.0, found) / (shown_area() * size * size) *
               dimming(glm::length(r.position)));
}

double LocalLamp::within_cone(const LampReceiver& r) const {
  LampBreakpoints at = breakpoints(r.position);
  const auto [first, last] = std::minmax_element(at.angles.begin(), at.angles.begin() + at.count);
  if (*last <= spot_cone.inner) return integral(r);
  if (*first >= spot_cone.outer) return 0;
  const double across = std::hypot(r.normal.x, r.normal.y),
               towards = std::atan2(r.normal.y, r.normal.x);
  // Circles about the axis are cut by the horizon from one angle to another.
  const double begin = *first, end = *last, cut = std::abs(std::atan2(r.normal.z, across));
  for (const double angle : {spot_cone.inner, cut, kPi - cut}) {
    if (angle > begin && angle < end) at.add(angle);
  }
  std::sort(at.angles.begin(), at.angles.begin() + at.count);
  double sum = 0;
  for (std::size_t i = 0; i + 1 < std::size_t(at.count); ++i) {
    const double from = at.angles[i], to = std::min(at.angles[i + 1], spot_cone.outer);
    if (!(to > from)) continue;
    for (int k = 0; k < kNodes; ++k) {
      const double s = kPi / 2 * kPlaces[std::size_t(k)];
      const double off_axis = (from + to + (to - from) * std::sin(s)) / 2,
                   step = kWeights[std::size_t(k)] * kPi / 4 * (to - from) * std::cos(s);
      // A place that sends this far off its axis is seen against the axis: the cosine is negative.
      const double along = -r.normal.z * std::cos(off_axis), sine = std::sin(off_axis);
      const LampArcs found = arcs(r.position, off_axis);
      double about = 0;
      for (int j = 0; j < found.count; ++j)
        about += cosine_over(found.arcs[std::size_t(j)], along, across * sine, towards);
      sum += spot_cone.at(off_axis) * sine * step * about;
    }
  }
  return sum;
}

glm::vec3 LocalLamp::point(const glm::vec2& u) const {
  return {shape == LampShape::rect ? u : glm::vec2(to_disk(u)), 0};
}

SourcePoint LocalLamp::seen(const glm::vec3& position, const glm::vec3& point) const {
  const glm::dvec3 from = local(position, glm::vec3(0)).position;
  const LampSample found = sample(from, glm::dvec2(point));
  const double share =
      spot_cone.is_open() ? 1 : spot_cone.at(std::acos(std::clamp(-found.to.z, -1.0, 1.0)));
  const double weight =
      share * found.solid_angle / (shown_area() * size * size) * dimming(glm::length(from));
  return {glm::vec3(glm::dmat3(axes) * found.to), float(found.distance * size), float(weight)};
}

SourceCone LocalLamp::cone(const glm::vec3& position) const {
  const glm::dvec3 way = glm::dvec3(center) - glm::dvec3(position);
  const double distance = glm::length(way), radius = reach() * size;
  const glm::vec3 to = distance > 0 ? glm::vec3(way / distance) : -axes[2];
  return {to, float(distance), float(distance > radius ? std::asin(radius / distance) : kPi / 2)};
}

}  // namespace ssdo
