// SPDX-License-Identifier: Apache-2.0
//
// A backdrop may stand on a ground that leads up to it: a card, the sides of a box, a cylinder of
// sky, or a sweep, whose ground bends into its wall along an arc. Its shape is that of the wall of
// a room or of the facade at the end of a street. This leaves its scale, and the only length in a
// frame to compare it with is the height of the camera above the ground. What is 150 times as far
// away as that, and rises 30 times as high with no sky above, is too large to be a wall: for a
// camera at eye level, 240 and 48 metres.
//
// A camera that stands on the floor of a hall comes near these limits, and nothing in the frame
// tells it from a high one before a card.
#include "scene/objects/standing_backdrop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <glm/geometric.hpp>
#include <iterator>
#include <string>
#include <vector>

namespace ssdo {
namespace {

/// Least distance and height of a backdrop over the height of the camera above the ground.
/// Measured: see man ssdo, OBJECTS.
constexpr double kFarAway = 150, kHigh = 30;

/// Least share of the far surfaces that lie on the backdrop, far being beyond half of the largest
/// distance: objects may stand before it.
constexpr double kMostOnIt = 0.8;

/// Share of the samples that show the ground.
constexpr double kLeastGround = 0.02;

/// Largest cosine between normals of surfaces that are perpendicular.
constexpr double kPerpendicular = 0.1;

/// How far below the ground a backdrop may be seen, over the height of the camera: where the ground
/// ends before the backdrop, what is seen behind the edge of the ground lies deeper.
constexpr double kBelow = 0.5;

/// The lowest and the highest place of a backdrop are these quantiles of its heights.
constexpr double kLowest = 0.005, kHighest = 0.95;

/// A backdrop is at least kHigher times as high as all else, but for kStandOut of the samples. A
/// roof is as high as its walls, and so are walls at the sides; trees and houses before a card are
/// not.
constexpr double kHigher = 2, kStandOut = 0.02;

/// Points of an arc have one radius, within this share of it.
constexpr double kOneRadius = 0.1;

/// A place on a sweep is upright if the cosine between its normal and the ground's is below this.
constexpr double kUpright = 0.7;

glm::dvec3 normal_of(const Surfel& s) { return glm::dvec3(s.normal); }

/// The ground: what is seen within a degree of its plane is on it.
struct Ground {
  Flat plane;

  double height(const Surfel& s) const {
    return plane.distance + glm::dot(plane.normal, glm::dvec3(s.position));
  }
  bool has(const Surfel& s) const {
    return std::abs(height(s)) <= kOnShape * distance_of(s) &&
           glm::dot(normal_of(s), plane.normal) > kInward;
  }
  bool is_below(const Flat& wall) const {
    return std::abs(glm::dot(wall.normal, plane.normal)) < kPerpendicular;
  }
};

/// The plane that most nearby surfaces lie on: most of those perpendicular to the far plane, or
/// else of all, since the far surfaces may be an arc instead of a plane.
std::optional<Ground> find_ground(const SurfelSamples& samples, double nearer_than,
                                  const Flat& far) {
  SurfelSamples nearby, lying;
  std::ranges::copy_if(samples, std::back_inserter(nearby),
                       [&](const Surfel& s) { return distance_of(s) < nearer_than; });
  std::ranges::copy_if(nearby, std::back_inserter(lying), [&](const Surfel& s) {
    return std::abs(glm::dot(normal_of(s), far.normal)) < kPerpendicular;
  });
  for (const SurfelSamples& of : {lying, nearby}) {
    const std::optional<Flat> plane = flat_of(of);
    if (!plane) continue;
    const Ground ground{*plane};
    const auto on = std::ranges::count_if(of, [&](const Surfel& s) { return ground.has(s); });
    if (double(on) >= kLeastGround * double(samples.size())) return ground;
  }
  return std::nullopt;
}

/// The arc that leads from a ground to a wall, and touches both.
struct Arc {
  Ground ground;
  Flat wall;
  double radius = 0;

  double above(const Surfel& s) const { return ground.height(s); }
  double before(const Surfel& s) const {
    return wall.distance + glm::dot(wall.normal, glm::dvec3(s.position));
  }
  /// Whether the normal is one that an arc between both has.
  bool turns_as(const Surfel& s) const {
    const double up = glm::dot(normal_of(s), ground.plane.normal),
                 out = glm::dot(normal_of(s), wall.normal);
    return up > -kPerpendicular && out > -kPerpendicular && std::hypot(up, out) > kInward;
  }
  /// The radius of the arc through a point u above the ground and v before the wall:
  /// (R - u)^2 + (R - v)^2 = R^2.
  double radius_through(const Surfel& s) const {
    const double u = std::max(above(s), 0.0), v = std::max(before(s), 0.0);
    return u + v + std::sqrt(2 * u * v);
  }
  bool has(const Surfel& s) const {
    return turns_as(s) && std::max(above(s), before(s)) < (1 + kOneRadius) * radius &&
           std::abs(radius_through(s) - radius) < kOneRadius * radius;
  }
  bool is_upright(const Surfel& s) const {
    return glm::dot(normal_of(s), ground.plane.normal) < kUpright;
  }
};

/// The arc that bent surfaces lie on, and its wall, which need not be seen. A place whose normal is
/// (up, out) is R (1 - up) above the ground and R (1 - out) before the wall.
std::optional<Arc> find_arc(const SurfelSamples& samples, const Ground& ground) {
  SurfelSamples bent;
  glm::dvec3 out(0);
  for (const Surfel& s : samples) {
    const double up = glm::dot(normal_of(s), ground.plane.normal);
    if (up < kPerpendicular || up > kInward) continue;
    bent.push_back(s);
    out += glm::normalize(normal_of(s) - up * ground.plane.normal);
  }
  if (bent.size() < kFewestOfShape || !(glm::length(out) > 0)) return std::nullopt;
  Arc arc{ground, {glm::normalize(out)}};
  std::erase_if(bent, [&](const Surfel& s) { return !arc.turns_as(s); });
  if (bent.size() < kFewestOfShape) return std::nullopt;
  std::vector<double> radii, distances;
  for (const Surfel& s : bent)
    radii.push_back(arc.above(s) / (1 - glm::dot(normal_of(s), ground.plane.normal)));
  arc.radius = median(radii);
  for (const Surfel& s : bent)
    distances.push_back(arc.radius * (1 - glm::dot(normal_of(s), arc.wall.normal)) - arc.before(s));
  arc.wall.distance = median(distances);
  if (!(arc.radius > 0 && arc.wall.distance > 0)) return std::nullopt;
  return arc;
}

/// What stands on the ground: its surfaces, how far away it is, and what it is called.
struct Standing {
  std::function<bool(const Surfel&)> has;
  double distance = 0;
  std::string name;
  std::function<bool(const Surfel&)> leads_to_it = {};  ///< null: nothing but the ground does
};

/// An arc, and the wall that it leads to.
std::optional<Standing> find_sweep(const SurfelSamples& far, const Ground& ground) {
  const std::optional<Arc> arc = find_arc(far, ground);
  if (!arc) return std::nullopt;
  const auto off = std::ranges::count_if(
      far, [&](const Surfel& s) { return !arc->wall.has(s) && !arc->has(s); });
  if (double(off) > (1 - kMostOnIt) * double(far.size())) return std::nullopt;
  return Standing{
      [arc](const Surfel& s) { return arc->wall.has(s) || (arc->has(s) && arc->is_upright(s)); },
      arc->wall.distance, "a sweep that rises from",
      [arc](const Surfel& s) { return arc->has(s); }};
}

std::optional<Standing> find_standing(const SurfelSamples& far, const Ground& ground) {
  const std::optional<RoundShape> round =
      round_of(far, ground.plane.normal, distance_of(far.front()));
  if (round && is_cylinder_around(*round, far, kMostOnIt))
    return Standing{[round](const Surfel& s) { return round->has(glm::dvec3(s.position)); },
                    round->radius, "a cylinder that stands on"};
  SurfelSamples left = far;
  const std::vector<Flat> flats =
      take_flats(left, kMostOnIt, [&](const Flat& flat) { return ground.is_below(flat); });
  if (double(left.size()) > (1 - kMostOnIt) * double(far.size())) return find_sweep(far, ground);
  double distance = flats.front().distance;
  for (const Flat& flat : flats) distance = std::min(distance, flat.distance);
  return Standing{[flats](const Surfel& s) {
                    return std::ranges::any_of(flats,
                                               [&](const Flat& flat) { return flat.has(s); });
                  },
                  distance,
                  flats.size() == 1 ? "a card that stands on"
                                    : fmt::format("{} cards that stand on", flats.size())};
}

}  // namespace

std::optional<BackdropShape> find_standing_backdrop(const SurfelSamples& samples) {
  const double farthest = farthest_of(samples);
  SurfelSamples far = farther_than(samples, 0.5 * farthest);
  const std::optional<Flat> plane = flat_of(far);
  if (!plane) return std::nullopt;
  const std::optional<Ground> ground = find_ground(samples, 0.5 * farthest, *plane);
  if (!ground) return std::nullopt;
  std::erase_if(far, [&](const Surfel& s) { return ground->has(s); });
  if (far.size() < kFewestOfShape) return std::nullopt;
  const std::optional<Standing> found = find_standing(far, *ground);
  if (!found) return std::nullopt;
  std::vector<double> heights;
  for (const Surfel& s : far)
    if (found->has(s)) heights.push_back(ground->height(s));
  if (heights.size() < kFewestOfShape) return std::nullopt;
  std::ranges::sort(heights);
  const auto height_at = [&](double share) {
    return heights[std::size_t(share * double(heights.size() - 1))];
  };
  const double camera = ground->plane.distance, top = height_at(kHighest);
  if (height_at(kLowest) < -kBelow * camera) return std::nullopt;
  std::vector<double> others;
  for (const Surfel& s : samples)
    if (!found->has(s) && !(found->leads_to_it && found->leads_to_it(s)))
      others.push_back(ground->height(s));
  const std::size_t out = std::size_t(kStandOut * double(samples.size()));
  double of_others = 0;
  if (out < others.size()) {
    std::ranges::nth_element(others, others.begin() + std::ptrdiff_t(out), std::greater<>());
    of_others = std::max(0.0, others[out]);
  }
  const double times = found->distance / camera;
  return BackdropShape{
      .has = found->has,
      .what = fmt::format("{} the ground, {:.3g} times as far away as the camera is high",
                          found->name, times),
      .clearance = std::min({times / kFarAway, top / camera / kHigh, top / (kHigher * of_others)}),
      .stands = true};
}

}  // namespace ssdo
