// SPDX-License-Identifier: Apache-2.0
//
// A point that moves is in the frame before where the motion of its own frame leads, and in the
// frame after where the motion of that one leads back from:
//
//   x(k - 1) = x(k) + m_k(x(k))          x(k + 1) + m_(k+1)(x(k + 1)) = x(k)
//
// The second is solved by iteration, from the pixels that moved to x(k), later from constant speed.
// Each step is tested as Reprojection does (filters/temporal.cpp): P may differ by twice the motion
// across the view. A frame that lacks the layer, or is missing, ends both chains.
//
// Light at a point that travels changes. With d the way from its place in the world in the one
// frame to that in the other, and c the cosine between both normals, another frame counts by
//
//   exp(-(d / D)^2) max(1 - (1 - c) / C, 0),   D = kReach times its distance
//
// and not at all for light of sources, whose shadows have edges. Between a quarter of a pixel and
// three quarters from where the point would be at rest, the lookup passes from the place of rest to
// the place that was followed, so that nothing changes at once when things begin to move.
#include "filters/shot/followed.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "filters/reprojection.h"

namespace ssdo {
namespace {

/// Fitted on four made shots (sliding, rolling and turning things, cars, a walker, a lift) by error
/// and flicker of white ao on what moves.
constexpr double kReach = 0.05, kTurn = 0.03;

/// Pixels from rest.
constexpr double kAtRest = 0.25, kFollowed = 0.75;

/// Length of a motion over the part of it across the view, as Reprojection has it.
constexpr double kSlant = 2;

/// Iterations, and the pixels by which they may miss.
constexpr int kTries = 5;
constexpr double kMiss = 0.1;

double ramp(double value, double from, double to) {
  return std::clamp((value - from) / (to - from), 0.0, 1.0);
}

bool is_finite(const glm::dvec2& v) { return std::isfinite(v.x) && std::isfinite(v.y); }

/// 0..1 of the motion of a pixel apart from the cameras; 0 where it is not known.
double speed_of(const OwnMotion& motion, std::size_t pixel) {
  const double speed = glm::length(motion.at(pixel));
  return speed > 0 ? ramp(speed, double(OwnMotion::kLeast), 2.0 * double(OwnMotion::kLeast)) : 0;
}

}  // namespace

/// A point in a frame, and the pixels around it that show its surface.
struct Followed::Spot {
  glm::dvec2 at;               ///< pixels of the display window
  glm::vec3 position, normal;  ///< camera space
  float rounding;
  std::int32_t pixel;  ///< as in Sights
  float weight[4];
};

Followed::Followed(const Findings& own, const std::vector<OtherFindings>& others) : own_(own) {
  link(others, -1, before_);
  link(others, 1, after_);
  mark_origins();
}

/// The frames that are reached through others, one after the other.
void Followed::link(const std::vector<OtherFindings>& others, int direction,
                    std::vector<Beside>& reached) {
  const Findings* last = &own_;
  for (int away = direction;; away += direction) {
    const auto next = std::ranges::find(others, away, &OtherFindings::away);
    if (next == others.end() || !next->findings->surfaces.world_known) return;
    const Findings &before = direction < 0 ? *next->findings : *last,
                   &after = direction < 0 ? *last : *next->findings;
    if (!after.motion.is_known) return;
    reached.push_back({std::size_t(next - others.begin()),
                       {&before.surfaces,
                        &after.surfaces,
                        &after.motion,
                        {after.surfaces, before.surfaces},
                        {before.surfaces, after.surfaces}},
                       {own_.surfaces, next->findings->surfaces}});
    last = next->findings;
  }
}

/// Pixels of the frame after, at the four around where they were: the one that was nearest.
void Followed::mark_origins() {
  if (after_.empty() || after_.front().link.motion->pixels.empty()) return;
  const Link& link = after_.front().link;
  const KeptSurfaces &own = own_.surfaces, &after = *link.after;
  const glm::dvec2 first = own.centre(own.index(0, 0));
  came_to_.assign(own.size(), -1);
  std::vector<float> distances(own.size(), 2.0f);
  for (std::size_t q = 0; q < after.size(); ++q) {
    if (speed_of(*link.motion, q) == 0 || !std::isfinite(after.pixels[q].position.z)) continue;
    const glm::dvec2 at =
        link.back.place(link.back.position(after.pixels[q].position)) + link.motion->at(q) - first;
    if (!(at.x > -1 && at.y > -1 && at.x < own.window.width() && at.y < own.window.height()))
      continue;
    for (int corner = 0; corner < 4; ++corner) {
      const double x = std::floor(at.x) + corner % 2, y = std::floor(at.y) + corner / 2;
      const std::size_t i = own.index(int(x), int(y));
      const auto distance = float(glm::distance(at, glm::dvec2(x, y)));
      if (distance < distances[i]) distances[i] = distance, came_to_[i] = std::int32_t(q);
    }
  }
}

Followed::Spot Followed::spot_of(std::size_t pixel) const {
  const KeptSurface& surface = own_.surfaces.pixels[pixel];
  return {own_.surfaces.centre(pixel),         surface.position,    normal_of(surface),
          rounding_of(surface, own_.surfaces), std::int32_t(pixel), {1, 0, 0, 0}};
}

void Followed::row(int y, std::vector<std::vector<FollowedPoint>>& points) const {
  for (std::vector<FollowedPoint>& of_other : points) of_other.clear();
  const bool moves = !before_.empty() && !own_.motion.pixels.empty();
  if (!moves && came_to_.empty()) return;
  for (int x = 0; x < own_.surfaces.window.width(); ++x) {
    const std::size_t i = own_.surfaces.index(x, y);
    if (!std::isfinite(own_.surfaces.pixels[i].position.z)) continue;
    if (moves && speed_of(own_.motion, i) > 0) follow_back(x, spot_of(i), points);
    if (!came_to_.empty() && came_to_[i] >= 0)
      follow_forth(x, spot_of(i), std::size_t(came_to_[i]), points);
  }
}

/// The motion to the frame before of what `spot`, in the later frame of the link, shows.
glm::dvec2 Followed::motion_at(const Link& link, const Spot& spot) {
  glm::dvec2 sum(0);
  for (int corner = 0; corner < 4; ++corner) {
    if (!(spot.weight[corner] > 0)) continue;
    const std::size_t i = std::size_t(spot.pixel + corner % 2 + corner / 2 * link.after->stride());
    const glm::dvec2 by_cameras =
        link.back.place(link.back.position(link.after->pixels[i].position)) - link.after->centre(i);
    sum += double(spot.weight[corner]) * (by_cameras + link.motion->at(i));
  }
  return sum;
}

/// The pixels around `at` in `to` that show the surface of `from`. False: none do.
bool Followed::find(const CameraChange& change, const KeptSurfaces& to, const Spot& from,
                    const glm::dvec2& at, Spot& found) {
  const glm::dvec3 p = change.position(from.position);
  const glm::vec3 normal = change.direction(from.normal);
  const Camera& camera = to.camera;
  const double scale = camera.orthographic ? 1.0 : -p.z;
  const glm::dvec2 off = (at - change.place(p)) / glm::dvec2(camera.fx, camera.fy),
                   place = at - to.centre(to.index(0, 0));
  const double left = std::floor(place.x), top = std::floor(place.y),
               limit =
                   scale * (0.5 / camera.fx + kSlant * glm::length(off)) + double(from.rounding);
  if (!(left >= -1 && top >= -1 && left < to.window.width() && top < to.window.height()) ||
      !std::isfinite(limit))
    return false;
  const double across = place.x - left, down = place.y - top;
  const std::size_t first = to.index(int(left), int(top));
  double sum = 0;
  glm::dvec3 position(0), normals(0);
  for (int corner = 0; corner < 4; ++corner) {
    const std::size_t i = first + std::size_t(corner % 2 + corner / 2 * to.stride());
    const KeptSurface& q = to.pixels[i];
    found.weight[corner] = 0;
    const double weight = (corner % 2 ? across : 1 - across) * (corner / 2 ? down : 1 - down);
    if (!(weight > 0) || !std::isfinite(q.position.z)) continue;
    const glm::vec3 other = normal_of(q);
    const glm::dvec3 away = glm::dvec3(q.position) - p;
    const double near = limit + double(rounding_of(q, to));
    if (double(glm::dot(normal, other)) < Reprojection::kSameNormal ||
        std::abs(glm::dot(glm::dvec3(normal), away)) > near ||
        std::abs(glm::dot(glm::dvec3(other), away)) > near)
      continue;
    found.weight[corner] = float(weight), sum += weight;
    position += weight * glm::dvec3(q.position), normals += weight * glm::dvec3(other);
  }
  if (sum < Reprojection::kLeastShare) return false;
  for (float& weight : found.weight) weight /= float(sum);
  found.at = at, found.pixel = std::int32_t(first);
  found.position = glm::vec3(position / sum), found.normal = glm::vec3(glm::normalize(normals));
  found.rounding = from.rounding;
  return true;
}

/// Adds to `points` where `beside` shows the point in column `x`, unless it is at rest there.
void Followed::add(int x, const Spot& start, const Spot& there, double speed, const Beside& beside,
                   std::vector<FollowedPoint>& points) const {
  const glm::dvec3 rest = beside.from_own.position(start.position);
  const double from_rest = glm::distance(there.at, beside.from_own.place(rest)),
               way = glm::distance(glm::dvec3(there.position), rest),
               follows = speed * ramp(from_rest, kAtRest, kFollowed);
  if (!(follows > 0)) return;
  const Camera& camera = own_.surfaces.camera;
  const double distance = camera.orthographic ? own_.surfaces.window.width() / camera.fx
                                              : glm::length(glm::dvec3(start.position)),
               reach = kReach * distance,
               turn = 1 - double(glm::dot(there.normal, beside.from_own.direction(start.normal)));
  const double counts = std::exp(-(way / reach) * (way / reach)) * ramp(turn, kTurn, 0);
  FollowedPoint point{x, there.pixel, {}, float(follows), float(counts)};
  std::copy_n(there.weight, 4, point.weight);
  points.push_back(point);
}

void Followed::follow_back(int x, const Spot& start,
                           std::vector<std::vector<FollowedPoint>>& points) const {
  const double speed = speed_of(own_.motion, std::size_t(start.pixel));
  Spot last = start, next;
  for (const Beside& beside : before_) {
    const Link& link = beside.link;
    if (!find(link.back, *link.before, last, last.at + motion_at(link, last), next)) return;
    add(x, start, next, speed, beside, points[beside.other]);
    last = next;
  }
}

/// `from` is a pixel of the frame after.
void Followed::follow_forth(int x, const Spot& start, std::size_t from,
                            std::vector<std::vector<FollowedPoint>>& points) const {
  const Link& first = after_.front().link;
  const double speed = speed_of(*first.motion, from);
  Spot last = start, next;
  next.pixel = std::int32_t(from);
  next.weight[0] = 1, next.weight[1] = next.weight[2] = next.weight[3] = 0;
  glm::dvec2 guess = start.at - motion_at(first, next);
  for (const Beside& beside : after_) {
    const Link& link = beside.link;
    const glm::dvec2 rest = link.forth.place(link.forth.position(last.position));
    bool found = false;
    for (int k = 0; k < kTries && !found; ++k) {
      if (!find(link.forth, *link.after, last, guess, next)) return;
      const glm::dvec2 off = next.at + motion_at(link, next) - last.at;
      if (!is_finite(off)) return;
      found = glm::length(off) < kMiss;
      if (!found) guess -= off;
    }
    if (!found) return;
    add(x, start, next, speed, beside, points[beside.other]);
    const glm::dvec2 own = next.at - rest;
    last = next;
    if (&beside == &after_.back()) return;
    const Link& following = (&beside + 1)->link;
    guess = following.forth.place(following.forth.position(last.position)) + own;
  }
}

}  // namespace ssdo
