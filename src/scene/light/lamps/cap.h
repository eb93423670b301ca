// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <numbers>

namespace ssdo {

/// A round patch of the sphere of directions: all within an angle of its middle. Two numbers keep
/// small and wide ones exact.
struct Cap {
  double sine = 0, cosine = 1;  ///< of the angle, 0 to pi

  /// The part of the sphere that a ball covers, seen from outside. Inside the ball, the cap grows
  /// from half of all directions on the surface of the ball to all of them in its middle, so that
  /// nothing jumps.
  static Cap of_ball(double radius, double distance) {
    const bool inside = distance < radius;
    const double sine = inside ? distance / radius : (distance > 0 ? radius / distance : 0);
    const double cosine = std::sqrt(std::max(0.0, (1 - sine) * (1 + sine)));
    return {sine, inside ? -cosine : cosine};
  }

  /// The part that a disk covers, seen from a point in front of its middle.
  static Cap of_disk(double radius, double distance) {
    const double to_edge = std::hypot(radius, distance);
    return {radius / to_edge, distance / to_edge};
  }

  /// 1 - cosine, without rounding.
  double height() const { return cosine > 0 ? sine * sine / (1 + cosine) : 1 - cosine; }
};

/// Integral of max(0, cos) over a cap of at most half of the sphere, over pi sin^2 of its angle;
/// `middle` is the cosine from the normal to its middle.
///
/// The exact form for a cap that the horizon cuts: Snyder 1996, Area Light Sources for Real-Time
/// Graphics (Microsoft Research MSR-TR-96-11). A cap so small that this form would lose precision
/// is treated as flat.
inline double mean_cosine_of_small_cap(double middle, const Cap& cap) {
  constexpr double kFlat = 1e-5;  // the form loses eps / sine, the flat one sine
  if (middle >= cap.sine) return middle;
  if (middle <= -cap.sine) return 0;
  if (cap.sine < kFlat) {
    const double t = middle / cap.sine, chord = std::sqrt(std::max(0.0, 1 - t * t));
    const double half_pi = std::numbers::pi / 2;
    return cap.sine * (t * (half_pi + std::asin(t)) + chord * (2 + t * t) / 3) / std::numbers::pi;
  }
  const double x = cap.cosine / cap.sine, across = std::sqrt(std::max(0.0, 1 - middle * middle));
  const double y = across > 0 ? std::clamp(-x * middle / across, -1.0, 1.0) : -1;
  const double w = across * std::sqrt(1 - y * y);
  return ((middle * std::acos(y) - x * w) + std::atan2(w, x) / (cap.sine * cap.sine)) /
         std::numbers::pi;
}

/// Integral of max(0, cos) over a cap, over pi.
inline double form_factor_of_cap(double middle, const Cap& cap) {
  if (cap.cosine >= 0) return cap.sine * cap.sine * mean_cosine_of_small_cap(middle, cap);
  const Cap rest{cap.sine, -cap.cosine};
  return 1 - rest.sine * rest.sine * mean_cosine_of_small_cap(-middle, rest);
}

/// Maps a point of the unit square to the unit disc: uniform points stay uniform, and near ones
/// near (Shirley and Chiu 1997, A Low Distortion Map Between Disk and Square).
inline glm::dvec2 to_disk(const glm::vec2& u) {
  const double a = 2.0 * u.x - 1, b = 2.0 * u.y - 1;
  if (a == 0 && b == 0) return glm::dvec2(0);
  const bool along_a = std::abs(a) > std::abs(b);
  const double r = along_a ? a : b, quarter = std::numbers::pi / 4;
  const double angle = along_a ? quarter * (b / a) : 2 * quarter - quarter * (a / b);
  return {r * std::cos(angle), r * std::sin(angle)};
}

/// The direction in a cap of this height about z for a place of the unit disk. Uniform places give
/// uniform directions, since area on a sphere is proportional to height.
inline glm::dvec3 direction_in_cap(double height, const glm::dvec2& disk) {
  const double down = glm::dot(disk, disk) * height;
  return {disk * std::sqrt(height * (2 - down)), 1 - down};
}

/// A right-handed orthonormal frame whose third column is the unit vector `n` (Duff et al. 2017,
/// Building an Orthonormal Basis, Revisited): frame_about() in double.
inline glm::dmat3 frame_of(const glm::dvec3& n) {
  const double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  return {glm::dvec3(1 + sign * n.x * n.x * a, sign * b, -sign * n.x),
          glm::dvec3(b, sign + n.y * n.y * a, -n.y), n};
}

}  // namespace ssdo
