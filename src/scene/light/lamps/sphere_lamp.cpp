// SPDX-License-Identifier: Apache-2.0
#include "scene/light/lamps/sphere_lamp.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "math/pi.h"
#include "scene/light/lamps/cap.h"

namespace ssdo {
namespace {

/// A receiver within this share of the radius sees the lamp right before it.
constexpr double kTouching = 1e-4;

/// The sphere as a receiver sees it.
struct Ball {
  double distance;  ///< to the middle
  glm::dvec3 to;
  Cap cap;

  Ball(const glm::dvec3& position, bool faces_receiver) : distance(glm::length(position)) {
    to = distance > 0 ? -position / distance : glm::dvec3(0, 0, -1);
    cap = faces_receiver ? Cap::of_disk(1, distance) : Cap::of_ball(1, distance);
  }
  double angle() const { return std::atan2(cap.sine, cap.cosine); }
  /// Between the middle and the direction against the axis.
  double off_axis() const { return std::atan2(std::hypot(to.x, to.y), -to.z); }
};

}  // namespace

double SphereLamp::shown_area() const { return kPi; }

double SphereLamp::integral(const LampReceiver& r) const {
  const Ball ball(r.position, faces_receiver);
  return kPi * form_factor_of_cap(glm::dot(r.normal, ball.to), ball.cap);
}

LampSample SphereLamp::sample(const glm::dvec3& position, const glm::dvec2& point) const {
  const Ball ball(position, faces_receiver);
  const double all = ball.cap.height();
  const glm::dvec3 in_cap = direction_in_cap(all, point);
  LampSample found{frame_of(ball.to) * in_cap, kTouching, 2 * kPi * all};
  if (faces_receiver) {
    found.distance = std::max(kTouching, ball.distance / std::max(in_cap.z, kTouching));
  } else if (ball.cap.cosine >= 0) {
    // Along the chord: its middle is nearest to that of the sphere.
    const double past = ball.distance * in_cap.z,
                 aside = ball.distance * std::hypot(in_cap.x, in_cap.y);
    found.distance = std::max(kTouching, past - std::sqrt(std::max(0.0, 1 - aside * aside)));
  }
  return found;
}

LampBreakpoints SphereLamp::breakpoints(const glm::dvec3& position) const {
  const Ball ball(position, faces_receiver);
  const double middle = ball.off_axis(), angle = ball.angle();
  const double far = middle + angle;
  return {{middle > angle ? middle - angle : 0, std::abs(middle - angle),
           far > kPi ? 2 * kPi - far : far, far > kPi ? kPi : far},
          4};
}

LampArcs SphereLamp::arcs(const glm::dvec3& position, double off_axis) const {
  const Ball ball(position, faces_receiver);
  const double middle = ball.off_axis();
  const double above = ball.cap.cosine - std::cos(middle) * std::cos(off_axis),
               across = std::sin(middle) * std::sin(off_axis);
  if (above >= across) return {};
  const double half = above <= -across ? kPi : std::acos(above / across);
  return {{{{std::atan2(ball.to.y, ball.to.x), half}}}, 1};
}

}  // namespace ssdo
