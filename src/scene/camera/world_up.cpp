// SPDX-License-Identifier: Apache-2.0
//
// The likelihood of the camera's pose if an axis is up, from how film cameras are held. The
// densities are choices, not fits. What decides is that most cameras have no roll at all, to the
// precision of P, while a wrong axis gives any roll: 3 in 1000 pass for level.
#include "scene/camera/world_up.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <tuple>

namespace ssdo {
namespace {

/// The odds from which on an axis is no guess, and the largest odds that are reported. Random poses
/// of cameras that are level, held by hand (2 degrees of roll) or tilted by 15 degrees are left to
/// a guess in 0.1, 2 and up to 54 % of cases.
constexpr double kLeastOdds = 20, kLargestOdds = 1000;

/// Most tools whose header does not tell have y up.
constexpr double kOddsOfY = 3;

double bell(double x, double deviation) {
  return std::exp(-0.5 * (x / deviation) * (x / deviation)) / deviation;
}

/// Prior density of the roll of a camera, in degrees: most are level, some are held by hand, few
/// are tilted on purpose.
double density_of_roll(double degrees) {
  return 0.8 * bell(degrees, 0.2) + 0.1 * bell(degrees, 3) + 0.08 * bell(degrees, 20) + 1e-4;
}

/// Prior density of the angle by which a camera looks down, in degrees. A camera that looks
/// straight down renders a plan.
constexpr double kStraightDown = 89.8;
double density_of_pitch(double degrees) {
  const double plan = degrees > kStraightDown ? 0.02 : 0;
  return std::exp(-0.5 * std::pow((degrees - 10) / 25, 2)) + 0.003 + plan;
}

/// Sine of 60 degrees.
constexpr double kFarAbove = 0.866;

/// An axis of the world that may be up; all in camera space.
struct Candidate {
  const char* name;
  glm::dvec3 axis;
  double likelihood = 0;
};

/// Share of the surfaces that look along an axis, to 25 degrees.
double share_of_floors(const Geometry& geometry, const glm::vec3& up) {
  constexpr std::size_t kMostSamples = 6000;
  constexpr float kClose = 0.9f;
  const std::size_t stride = (geometry.surfaces.size() / kMostSamples) | 1;
  double floors = 0, surfaces = 0;
  for (std::size_t i = 0; i < geometry.surfaces.size(); i += stride) {
    if (!geometry.is_surface(i)) continue;
    surfaces += 1;
    floors += glm::dot(geometry.surfaces[i].normal, up) > kClose;
  }
  return floors / std::max(surfaces, 1.0);
}

double likelihood_of(const glm::dvec3& up, const Geometry& geometry) {
  // The camera looks along -z, x is to its right and y is its own up.
  const double pitch = glm::degrees(std::asin(std::clamp(up.z, -1.0, 1.0)));
  // Seen straight from above, the roll is undefined.
  const double roll = std::abs(pitch) > kStraightDown ? 0 : glm::degrees(std::atan2(up.x, up.y));
  constexpr double kAnyScene = 0.2;
  return density_of_roll(roll) * density_of_pitch(pitch) *
         (kAnyScene + share_of_floors(geometry, glm::vec3(up)));
}

/// The six directions that may be up, y and z first.
std::array<Candidate, 6> directions_of(const Geometry& geometry) {
  const glm::dmat3 world(geometry.world_to_camera);
  return {{{"y", world[1]},
           {"z", world[2]},
           {"x", world[0]},
           {"-y", -world[1]},
           {"-z", -world[2]},
           {"-x", -world[0]}}};
}

}  // namespace

UpEvidence up_evidence(const Geometry& geometry) {
  UpEvidence evidence;
  const auto all = directions_of(geometry);
  for (std::size_t i = 0; i < all.size(); ++i)
    evidence[i] = std::log(likelihood_of(all[i].axis, geometry));
  return evidence;
}

/// Whether the header tells which axis is up: Blender and Unreal always have z up.
bool header_tells_up(const GBuffer& g) {
  const auto unreal = g.header.lower_bound("unreal/");
  return g.by_blender || (unreal != g.header.end() && unreal->first.starts_with("unreal/"));
}

WorldUp find_world_up(const GBuffer& g, const Geometry& geometry,
                      const std::optional<UpEvidence>& of_shot) {
  const UpEvidence evidence = of_shot ? *of_shot : up_evidence(geometry);
  std::array<Candidate, 6> all = directions_of(geometry);
  for (std::size_t i = 0; i < all.size(); ++i) all[i].likelihood = std::exp(evidence[i]);
  all[0].likelihood *= kOddsOfY;
  const Candidate &y = all[0], &z = all[1];
  const Candidate& best = *std::max_element(
      all.begin(), all.end(),
      [](const Candidate& a, const Candidate& b) { return a.likelihood < b.likelihood; });
  const auto is_surely = [&](const Candidate& other, const Candidate& than) {
    return other.likelihood > kLeastOdds * than.likelihood;
  };
  if (header_tells_up(g)) {
    WorldUp up{UpAxis::z, "by the header", ""};
    // A view from far above may have any direction to its right.
    if (is_surely(best, z) && std::abs(z.axis.z) < kFarAbove) {
      up.warning = fmt::format(
          "the header says that z is up in the world of P, and the camera is held as if {} were: "
          "taken as z; give --env-up to be sure",
          best.name);
    }
    return up;
  }
  const bool y_or_z = &best == &y || &best == &z;
  if (!y_or_z && is_surely(best, y) && is_surely(best, z)) {
    return {UpAxis::y, "a guess",
            fmt::format("the camera is held as if {} were up in the world of P: the environment is "
                        "placed with y up; turn P and N, or give --env-up z",
                        best.name),
            false};
  }
  for (const auto& [axis, taken, other] :
       {std::tuple{UpAxis::z, &z, &y}, std::tuple{UpAxis::y, &y, &z}}) {
    if (!is_surely(*taken, *other)) continue;
    const double odds = std::min(taken->likelihood / other->likelihood, kLargestOdds);
    return {axis, fmt::format("by the camera{}, {:.0f} to 1", of_shot ? " of the shot" : "", odds),
            ""};
  }
  return {
      UpAxis::y, "a guess",
      "the camera does not surely tell whether y or z is up in the world of P: taken as y; give "
      "--env-up y or --env-up z",
      false};
}

}  // namespace ssdo
