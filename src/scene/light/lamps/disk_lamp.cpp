// SPDX-License-Identifier: Apache-2.0
//
// Lambert's formula (Photometria, 1760): what an even flat lamp gives is an integral along its
// border,
//
//   integral of the cosine = -1/2 of the integral of n . (r x dr) / |r|^2
//
// r being the way from the receiver to the border, counter-clockwise seen from the front, and n its
// normal. The part of a disk above the receiver's horizon has an arc and a chord as its border.
#include "scene/light/lamps/disk_lamp.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "math/pi.h"
#include "scene/light/lamps/cap.h"

namespace ssdo {
namespace {

/// The integrals of 1, cos and sin over a - b cos along an arc of the unit circle; `s` is
/// sqrt(a^2 - b^2).
struct ArcIntegrals {
  double one = 0, cosine = 0, sine = 0;

  ArcIntegrals(double a, double b, double s, double from, double to) {
    constexpr double kEven = 1e-6;  // b / a: below this, (a * one - span) / b is only rounding
    const double span = to - from;
    if (b < kEven * a) {
      one = span / a, cosine = (std::sin(to) - std::sin(from)) / a;
      sine = (std::cos(from) - std::cos(to)) / a;
      return;
    }
    const auto half = [&](double angle) {
      return std::atan2((a + b) * std::sin(angle / 2), s * std::cos(angle / 2));
    };
    one = 2 / s * (half(to) - half(from));
    cosine = (a * one - span) / b;
    sine = std::log((a - b * std::cos(to)) / (a - b * std::cos(from))) / b;
  }
};

/// The space of a disk, turned about its axis so that the receiver is at (off, 0, height).
struct Turned {
  double off, height;
  glm::dvec2 out{1, 0};  ///< from the axis to the receiver

  explicit Turned(const glm::dvec3& p) : off(std::hypot(p.x, p.y)), height(p.z) {
    if (off > 0) out = glm::dvec2(p) / off;
  }
  glm::dvec3 into(const glm::dvec3& v) const {
    return {v.x * out.x + v.y * out.y, v.y * out.x - v.x * out.y, v.z};
  }
  glm::dvec3 back(const glm::dvec3& v) const {
    return {v.x * out.x - v.y * out.y, v.y * out.x + v.x * out.y, v.z};
  }
};

}  // namespace

double DiskLamp::shown_area() const { return kPi; }

// With p = (off, 0, h), the border r(a) = (cos a, sin a, 0) - p has
//   n . (r x dr) = n_z + (n_x h - n_z off) cos a + n_y h sin a,   |r|^2 = A - B cos a
double DiskLamp::integral(const LampReceiver& r) const {
  if (!(r.position.z > 0)) return 0;
  const Turned turned(r.position);
  const glm::dvec3 n = turned.into(r.normal);
  const double off = turned.off, h = turned.height;
  const double a = 1 + off * off + h * h, b = 2 * off;
  const double s = std::hypot(1 - off, h) * std::hypot(1 + off, h);  // sqrt(A^2 - B^2)
  // The border is above the horizon where tilt * cos(angle - towards) > cut.
  const double tilt = std::hypot(n.x, n.y), cut = n.x * off + n.z * h, factor = n.x * h - n.z * off;
  if (cut >= tilt || !(s > 0)) return 0;
  if (cut <= -tilt) return -kPi * (n.z + factor * b / (a + s)) / s;
  const double towards = std::atan2(n.y, n.x), half = std::acos(cut / tilt);
  const double from = towards - half, to = towards + half;
  const ArcIntegrals arc(a, b, s, from, to);
  const glm::dvec3 first(std::cos(from) - off, std::sin(from), -h),
      last(std::cos(to) - off, std::sin(to), -h);
  const double chord = std::atan2(glm::dot(n, glm::cross(last, first)), glm::dot(last, first));
  return -(n.z * arc.one + factor * arc.cosine + n.y * h * arc.sine + chord) / 2;
}

// A receiver sees a disk as an ellipse on the sphere of directions, whose middle halves the angle
// between its nearest and its farthest point. Even points of a disk, made as long and as wide as
// the ellipse and lifted to the sphere, cover it with a density that varies by a factor of two at
// most (after Guillen et al. 2017, Area-Preserving Parameterizations for Spherical Ellipses).
LampSample DiskLamp::sample(const glm::dvec3& position, const glm::dvec2& point) const {
  const Turned turned(position);
  if (!(turned.height > 0)) return {{0, 0, 1}, std::max(1.0, glm::length(position)), 0};
  const double off = turned.off, h = std::max(turned.height, kNearestToPlane);
  const glm::dvec2 to_near(1 - off, -h), to_far(-1 - off, -h);  // in the plane of the axis
  const glm::dvec2 one = to_near / glm::length(to_near), other = to_far / glm::length(to_far);
  glm::dvec2 middle = one + other;
  // Sine of half the angle between them; far away, that angle is small.
  const double cosine = glm::dot(one, other);
  const double sine = 2 * h / (glm::length(to_near) * glm::length(to_far));
  const double length = cosine > 0 ? sine / glm::length(middle) : std::sqrt((1 - cosine) / 2);
  // Right at the disk, they are opposite to each other.
  middle = glm::length(middle) > 1e-9 ? glm::normalize(middle) : glm::dvec2(0, -1);
  const glm::dvec2 along(-middle.y, middle.x);
  // The chord through the middle of the ellipse is its width.
  const double way = -h / middle.y, at = off + middle.x * way,
               half_chord = std::sqrt(std::max(0.0, 1 - at * at));
  const double width = half_chord / std::hypot(half_chord, way);
  const double radius_squared = glm::dot(point, point);
  const glm::dvec2 edge = radius_squared > 0
                              ? point / std::sqrt(radius_squared) * glm::dvec2(length, width)
                              : glm::dvec2(length, 0);
  const double border = std::min(1.0, glm::dot(edge, edge));  // sine^2 of its angle
  // 1 - cosine at the border; points are even in it.
  const double all = border / (1 + std::sqrt(1 - border)), height = radius_squared * all;
  const double stretch = border > 0 ? std::sqrt(height * (2 - height) / border) : 0;
  const glm::dvec2 flat = edge * stretch;
  const glm::dvec3 to((along * flat.x + middle * (1 - height)).x, flat.y,
                      (along * flat.x + middle * (1 - height)).y);
  LampSample found;
  found.to = turned.back(to);
  found.distance = h / std::max(-to.z, 1e-12);
  found.solid_angle = border > 0 ? 2 * kPi * all * length * width / border : 0;
  return found;
}

LampBreakpoints DiskLamp::breakpoints(const glm::dvec3& position) const {
  const Turned turned(position);
  if (!(turned.height > 0)) return {{kPi, kPi}, 2};
  const double near = turned.off - 1;
  return {{near > 0 ? std::atan2(near, turned.height) : 0,
           std::atan2(std::abs(near), turned.height), std::atan2(turned.off + 1, turned.height)},
          3};
}

LampArcs DiskLamp::arcs(const glm::dvec3& position, double off_axis) const {
  const Turned turned(position);
  const double radius = turned.height * std::tan(off_axis);
  // The places on the plane of the lamp at this angle, within 1 of its middle.
  const double inside = (1 - turned.off * turned.off - radius * radius) / 2,
               across = turned.off * radius;
  if (inside <= -across) return {};
  const double half = inside >= across ? kPi : std::acos(-inside / across);
  return {{{{std::atan2(-turned.out.y, -turned.out.x), half}}}, 1};
}

}  // namespace ssdo
