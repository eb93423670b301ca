// SPDX-License-Identifier: Apache-2.0
//
// In the frame before, a moving point lies where the motion layer of its own frame leads; in the
// frame after, it lies where the motion layer of that frame leads back to it:
//
//   x(k - 1) = x(k) + m_k(x(k))          x(k + 1) + m_(k+1)(x(k + 1)) = x(k)
//
// The second is solved by iteration, from the pixels that moved to x(k), later from constant speed.
// Each step is tested as Reprojection does (filters/temporal.cpp): P may differ by twice the motion
// across the view. A frame that lacks the layer, or is missing, ends both chains.
//
// Light at a moving point changes. With d the distance between its places in the world in the two
// frames, and c the cosine between its two normals, another frame has the weight
//
//   exp(-(d / D)^2) max(1 - (1 - c) / C, 0),   D = kReach times its distance
//
// and not at all for light of sources, whose shadows have edges. Between a quarter of a pixel and
// three quarters from where the point would be at rest, the lookup passes from the place of rest to
// the place that was followed, so that nothing changes at once when things begin to move.
#include "filters/shot/point_tracker.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "filters/reprojection.h"

namespace ssdo {
namespace {

/// Fitted on four made shots (sliding, rolling and turning things, cars, a walker, a lift) by error
/// and flicker of white ao on what moves.
constexpr double kReach = 0.05, kTurn = 0.03;

/// Distances from the place of rest, in pixels, between which the lookup changes.
constexpr double kAtRest = 0.25, kFollowed = 0.75;

/// Length of a motion over the part of it across the view, as Reprojection has it.
constexpr double kSlant = 2;

/// Most iterations, and the pixels by which their result may miss.
constexpr int kTries = 5;
constexpr double kMiss = 0.1;

double ramp(double value, double from, double to) {
  return std::clamp((value - from) / (to - from), 0.0, 1.0);
}

bool is_finite(const glm::dvec2& v) { return std::isfinite(v.x) && std::isfinite(v.y); }

/// 0..1: how surely a pixel moves by more than noise, apart from the cameras; 0 where unknown.
double speed_of(const ObjectMotion& motion, std::size_t pixel) {
  const double speed = glm::length(motion.at(pixel));
  return speed > 0 ? ramp(speed, double(ObjectMotion::kLeast), 2.0 * double(ObjectMotion::kLeast))
                   : 0;
}

}  // namespace

PointTracker::PointTracker(const Findings& own) : own_(own), last_(&own) {}

// A frame that is missing, or lacks its motion, ends the chain to the frames beyond it.
void PointTracker::reach(const std::vector<OtherFindings>& others) {
  neighbours_.clear(), came_to_ = {};
  for (std::size_t k = 0; k < others.size(); ++k) {
    const Findings& next = *others[k].findings;
    const int away = others[k].away, direction = away < 0 ? -1 : 1;
    if (direction * last_away_ < 0) last_ = &own_, last_away_ = 0;
    const Findings* last = std::exchange(last_, nullptr);
    const bool is_next = std::exchange(last_away_, away) == away - direction;
    if (!last || !is_next || !next.surfaces.world_known) continue;
    const Findings &before = away < 0 ? next : *last, &after = away < 0 ? *last : next;
    if (!after.motion.is_known) continue;
    last_ = &next;
    neighbours_.push_back({k,
                           away < 0,
                           away == direction,
                           {&before.surfaces,
                            &after.surfaces,
                            &after.motion,
                            {after.surfaces.camera, before.surfaces.camera},
                            {before.surfaces.camera, after.surfaces.camera}},
                           {own_.surfaces.camera, next.surfaces.camera}});
    if (away == 1) mark_origins(neighbours_.back().link);
  }
  if (tracks_.empty() && !neighbours_.empty())
    tracks_.resize(std::size_t(own_.surfaces.window.height()));
}

/// Finds for each pixel which moving pixel of the frame after was nearest to it (`came_to_`). Each
/// is tried at the four pixels around the place where it was.
void PointTracker::mark_origins(const Link& link) {
  if (link.motion->pixels.empty()) return;
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
      const int right = corner % 2, down = corner / 2;
      const double x = std::floor(at.x) + right, y = std::floor(at.y) + down;
      const std::size_t i = own.index(int(x), int(y));
      const auto distance = float(glm::distance(at, glm::dvec2(x, y)));
      if (distance < distances[i]) distances[i] = distance, came_to_[i] = std::int32_t(q);
    }
  }
}

PointTracker::TrackedPosition PointTracker::position_of(std::size_t pixel) const {
  const KeptSurface& surface = own_.surfaces.pixels[pixel];
  return {own_.surfaces.centre(pixel),
          glm::dvec2(0),
          surface.position,
          normal_of(surface),
          rounding_of(surface, own_.surfaces),
          std::int32_t(pixel),
          {1, 0, 0, 0}};
}

/// The moving points of a row, at the start of their track to the adjacent frame `next`.
std::vector<PointTracker::Track> PointTracker::tracks_of(int y, const NeighbourFrame& next) const {
  std::vector<Track> tracks;
  if (next.is_before ? own_.motion.pixels.empty() : came_to_.empty()) return tracks;
  for (int x = 0; x < own_.surfaces.window.width(); ++x) {
    const std::size_t i = own_.surfaces.index(x, y);
    if (!std::isfinite(own_.surfaces.pixels[i].position.z)) continue;
    Track track{x, 0, position_of(i), glm::dvec2(0)};
    if (next.is_before) {
      track.speed = speed_of(own_.motion, i);
    } else if (came_to_[i] >= 0) {
      const std::size_t there(came_to_[i]);
      track.speed = speed_of(*next.link.motion, there);
      track.step = -next.link.motion->at(there);
    }
    if (track.speed > 0) tracks.push_back(track);
  }
  return tracks;
}

void PointTracker::row(int y, bool are_last, std::vector<std::vector<TrackedPoint>>& points) {
  for (std::vector<TrackedPoint>& of_other : points) of_other.clear();
  if (neighbours_.empty()) return;
  std::vector<Track> tracks = std::exchange(tracks_[std::size_t(y)], {});
  for (const NeighbourFrame& beside : neighbours_) {
    if (beside.is_next) tracks = tracks_of(y, beside);
    std::erase_if(tracks, [&](Track& track) {
      return !(beside.is_before ? go_back(beside.link, track) : go_forth(beside.link, track));
    });
    for (const Track& track : tracks) add(y, track, beside, points[beside.other]);
  }
  if (!are_last) tracks_[std::size_t(y)] = std::move(tracks);
}

/// The motion to the frame before, apart from the cameras, of what `spot` of the later frame shows.
glm::dvec2 PointTracker::motion_at(const Link& link, const TrackedPosition& spot) {
  glm::dvec2 sum = spot.aside;
  for (int corner = 0; corner < 4; ++corner) {
    if (!(spot.weight[corner] > 0)) continue;
    const int i = spot.pixel + corner % 2 + corner / 2 * link.after->stride();
    sum += double(spot.weight[corner]) * link.motion->at(std::size_t(i));
  }
  return sum;
}

/// The pixels of `to` that show the surface of `from`, around the place to which it has moved by
/// `step` pixels apart from the cameras. False: none do.
bool PointTracker::find(const CameraChange& change, const KeptSurfaces& to,
                        const TrackedPosition& from, const glm::dvec2& step,
                        TrackedPosition& found) {
  const glm::dvec3 p = change.position(from.position);
  const glm::vec3 normal(change.direction(from.normal));
  const Camera& camera = to.camera;
  const double scale = camera.orthographic ? 1.0 : -p.z,
               moved = glm::length(step / glm::dvec2(camera.fx, camera.fy));
  const glm::dvec2 at = change.place(p) + step, place = at - to.centre(to.index(0, 0));
  const double left = std::floor(place.x), top = std::floor(place.y),
               limit = scale * (0.5 / camera.fx + kSlant * moved) + double(from.rounding);
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
  const float* w = found.weight;
  found.at = at, found.pixel = std::int32_t(first);
  found.aside = glm::dvec2(across, down) - glm::dvec2(double(w[1] + w[3]), double(w[2] + w[3]));
  found.position = glm::vec3(position / sum), found.normal = glm::vec3(glm::normalize(normals));
  found.rounding = from.rounding;
  return true;
}

/// Moves a track to the frame before. False: that frame does not show the point.
bool PointTracker::go_back(const Link& link, Track& track) const {
  const TrackedPosition from = track.last;
  return find(link.back, *link.before, from, motion_at(link, from), track.last);
}

bool PointTracker::go_forth(const Link& link, Track& track) const {
  const TrackedPosition from = track.last;
  for (int k = 0; k < kTries; ++k) {
    if (!find(link.forth, *link.after, from, track.step, track.last)) return false;
    const glm::dvec2 off = link.back.place(link.back.position(track.last.position)) +
                           motion_at(link, track.last) - from.at;
    if (!is_finite(off)) return false;
    if (glm::length(off) < kMiss) return true;
    track.step -= off;
  }
  return false;
}

/// Adds to `points` where `beside` shows the point, unless it is at rest there.
void PointTracker::add(int y, const Track& track, const NeighbourFrame& beside,
                       std::vector<TrackedPoint>& points) const {
  const TrackedPosition start = position_of(own_.surfaces.index(track.x, y)), &there = track.last;
  const glm::dvec3 rest = beside.from_own.position(start.position);
  const double from_rest = glm::distance(there.at, beside.from_own.place(rest)),
               way = glm::distance(glm::dvec3(there.position), rest),
               follows = track.speed * ramp(from_rest, kAtRest, kFollowed);
  if (!(follows > 0)) return;
  const Camera& camera = own_.surfaces.camera;
  const double distance = camera.orthographic ? own_.surfaces.window.width() / camera.fx
                                              : glm::length(glm::dvec3(start.position)),
               reach = kReach * distance,
               turn = 1 - double(glm::dot(there.normal,
                                          glm::vec3(beside.from_own.direction(start.normal))));
  const double counts = std::exp(-(way / reach) * (way / reach)) * ramp(turn, kTurn, 0);
  TrackedPoint point{track.x, there.pixel, {}, float(follows), float(counts)};
  std::copy_n(there.weight, 4, point.weight);
  points.push_back(point);
}

}  // namespace ssdo
