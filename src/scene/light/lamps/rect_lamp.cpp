// SPDX-License-Identifier: Apache-2.0
//
// Lambert's formula (Photometria, 1760) for a polygon: with unit vectors to its corners,
//
//   integral of the cosine = 1/2 of the sum over edges of (angle of the edge) (n . normal of the
//                            plane through the receiver and the edge)
//
// after the part below the receiver's horizon has been cut off.
#include "scene/light/lamps/rect_lamp.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/pi.h"

namespace ssdo {
namespace {

double along_edge(const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& normal) {
  const glm::dvec3 across = glm::cross(from, to);
  const double sine = glm::length(across);
  if (!(sine > 0)) return 0;
  return std::atan2(sine, glm::dot(from, to)) * glm::dot(normal, across) / sine;
}

/// The rectangle about the foot of a receiver that is `height` above its plane.
struct Sides {
  glm::dvec2 low, high;
  double height;

  Sides(const glm::dvec2& half, const glm::dvec3& position)
      : low(-half - glm::dvec2(position)), high(half - glm::dvec2(position)), height(position.z) {}
};

/// The solid angle of a rectangle and its even points (Urena, Fajardo and King 2013, An Area-
/// Preserving Parametrization for Spherical Rectangles). The angles at its corners are those
/// between the planes through the receiver and its sides; those through the sides at low and high y
/// meet the z axis at cosines of `low` and `high`.
struct SphericalRectangle {
  double low, high, solid_angle, rest;

  explicit SphericalRectangle(const Sides& s) {
    const double h = s.height;
    low = -s.low.y / std::hypot(s.low.y, h), high = s.high.y / std::hypot(s.high.y, h);
    const double left = -s.low.x / std::hypot(s.low.x, h),
                 right = s.high.x / std::hypot(s.high.x, h);
    const auto corner = [](double one, double other) { return std::acos(-one * other); };
    rest = 2 * kPi - corner(left, low) - corner(left, high);
    solid_angle = corner(right, low) + corner(right, high) - rest;
  }

  /// The x at which a share of the solid angle lies to the left.
  double x_at(double share, const Sides& s) const {
    const double angle = share * solid_angle + rest;
    const double f = (std::cos(angle) * low - high) / std::sin(angle);
    const double c = std::copysign(1 / std::hypot(f, low), f);
    const double x = c * s.height / std::sqrt(std::max(1e-300, 1 - c * c));
    return std::clamp(std::isfinite(x) ? x : 0, s.low.x, s.high.x);
  }
};

}  // namespace

double RectLamp::integral(const LampReceiver& r) const {
  if (!(r.position.z > 0)) return 0;
  const std::array<glm::dvec2, 4> corners = {-half_sides, glm::dvec2(half_sides.x, -half_sides.y),
                                             half_sides, glm::dvec2(-half_sides.x, half_sides.y)};
  double sum = 0;
  glm::dvec3 first(0), last(0);  // corners of what is above the horizon
  bool any = false;
  const auto go_to = [&](const glm::dvec3& place) {
    if (any)
      sum += along_edge(last, place, r.normal);
    else
      first = place;
    any = true, last = place;
  };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3 from = glm::dvec3(corners[i], 0) - r.position,
                     to = glm::dvec3(corners[(i + 1) % 4], 0) - r.position;
    const double above = glm::dot(from, r.normal), next = glm::dot(to, r.normal);
    if (above > 0) go_to(from);
    if ((above > 0) != (next > 0)) go_to(from + (to - from) * (above / (above - next)));
  }
  if (!any) return 0;
  return -(sum + along_edge(last, first, r.normal)) / 2;
}

LampSample RectLamp::sample(const glm::dvec3& position, const glm::dvec2& point) const {
  Sides s(half_sides, position);
  if (!(s.height > 0)) return {{0, 0, 1}, std::max(1.0, glm::length(position)), 0};
  const double h = s.height = std::max(s.height, kNearestToPlane);
  if (glm::dot(position, position) > kFarFromRect * kFarFromRect) {
    const glm::dvec3 way(s.low + (s.high - s.low) * point, -h);
    const double squared = glm::dot(way, way), distance = std::sqrt(squared);
    return {way / distance, distance, shown_area() * h / (distance * squared)};
  }
  const SphericalRectangle seen(s);
  const double x = seen.x_at(point.x, s), away = std::hypot(x, h);
  // Along a line, the solid angle goes with the sine.
  const double sine =
      glm::mix(s.low.y / std::hypot(away, s.low.y), s.high.y / std::hypot(away, s.high.y), point.y);
  const double y = away * sine / std::sqrt(std::max(1e-300, (1 - sine) * (1 + sine)));
  const glm::dvec3 way(x, std::clamp(y, s.low.y, s.high.y), -h);
  const double distance = glm::length(way);
  return {way / distance, distance, std::max(0.0, seen.solid_angle)};
}

LampBreakpoints RectLamp::breakpoints(const glm::dvec3& position) const {
  const Sides s(half_sides, position);
  if (!(s.height > 0)) return {{kPi, kPi}, 2};
  const double begin = glm::length(glm::max(glm::max(s.low, -s.high), glm::dvec2(0))),
               end = glm::length(glm::max(glm::abs(s.low), glm::abs(s.high)));
  LampBreakpoints breakpoints;
  const auto add = [&](double radius) {
    breakpoints.add(std::atan2(std::clamp(radius, begin, end), s.height));
  };
  add(begin), add(end);
  // Sides and corners that the circles about the foot pass in between.
  for (const double x : {s.low.x, s.high.x}) {
    add(std::abs(x));
    for (const double y : {s.low.y, s.high.y}) add(std::hypot(x, y));
  }
  for (const double y : {s.low.y, s.high.y}) add(std::abs(y));
  return breakpoints;
}

LampArcs RectLamp::arcs(const glm::dvec3& position, double off_axis) const {
  const Sides s(half_sides, position);
  const double radius = s.height * std::tan(off_axis);
  // The circle is cut where it leaves a side; between two cuts, it is inside or outside.
  std::array<double, 8> cuts;
  cuts.fill(INFINITY);
  std::size_t count = 0;
  const auto cut = [&](double cosine, double towards) {
    if (std::abs(cosine) >= 1) return;
    const double angle = std::acos(cosine);
    cuts[count++] = std::remainder(towards + angle, 2 * kPi);
    cuts[count++] = std::remainder(towards - angle, 2 * kPi);
  };
  cut(s.low.x / radius, 0), cut(s.high.x / radius, 0);
  cut(s.low.y / radius, kPi / 2), cut(s.high.y / radius, kPi / 2);
  const auto is_inside = [&](double angle) {
    const glm::dvec2 at = radius * glm::dvec2(std::cos(angle), std::sin(angle));
    return at.x >= s.low.x && at.x <= s.high.x && at.y >= s.low.y && at.y <= s.high.y;
  };
  LampArcs found;
  if (count == 0) {
    if (is_inside(0)) found = {{{{0, kPi}}}, 1};
    return found;
  }
  std::sort(cuts.begin(), cuts.end());
  for (std::size_t i = 0; i < count; ++i) {
    const double from = cuts[i], to = i + 1 < count ? cuts[i + 1] : cuts[0] + 2 * kPi;
    const LampArc arc{(from + to) / 2, (to - from) / 2};
    if (!is_inside(arc.middle)) continue;
    if (found.count < int(found.arcs.size())) found.arcs[std::size_t(found.count++)] = arc;
  }
  return found;
}

}  // namespace ssdo
