// SPDX-License-Identifier: Apache-2.0
#include "scene/light/surroundings.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "math/frame.h"
#include "scene/light/distant_source.h"

namespace ssdo {
namespace {

/// The patches by which a region is widened: a partly covered texel, and one that resizing of the
/// map has lit.
constexpr int kFringe = 2;

/// The width of a ring, which is at least two patches wide.
const float kRing = glm::radians(1.0f);

/// The brightest part of a ring is left out: another source may stand beside this one.
constexpr double kOtherSources = 0.25;

/// Radians squared that are added to the spread of a ring: one that spreads less has no slope.
constexpr double kLeastSpread = 1e-6;

}  // namespace

RegionAndRing widen(const SkyGrid& grid, const SunRegion& region) {
  RegionAndRing out;
  out.patches = region.patches;
  std::vector<bool> reached(grid.patches.size());
  for (const std::size_t patch : region.patches) reached[patch] = true;
  std::vector<std::size_t> edge = region.patches, next;
  const auto step = [&](const auto& takes) {
    next.clear();
    for (const std::size_t from : edge) {
      grid.for_each_neighbour(from, [&](std::size_t to) {
        if (reached[to] || !takes(from, to)) return;
        reached[to] = true;
        next.push_back(to);
      });
    }
    edge = next;
  };
  // A patch that is brighter than the one before belongs to something else.
  for (int i = 0; i < kFringe; ++i) {
    step(
        [&](std::size_t from, std::size_t to) { return grid.radiance(to) <= grid.radiance(from); });
    out.patches.insert(out.patches.end(), edge.begin(), edge.end());
  }
  edge = out.patches;
  const int steps = std::max(2, int(std::ceil(kRing * float(grid.rows) / glm::pi<float>())));
  for (int i = 0; i < steps; ++i) {
    step([&](std::size_t, std::size_t to) { return grid.radiance(to) < region.threshold; });
    out.ring.insert(out.ring.end(), edge.begin(), edge.end());
  }
  const auto kept =
      out.ring.begin() + std::ptrdiff_t(double(out.ring.size()) * (1 - kOtherSources));
  std::nth_element(out.ring.begin(), kept, out.ring.end(), [&](std::size_t a, std::size_t b) {
    return grid.radiance(a) < grid.radiance(b);
  });
  out.ring.erase(kept, out.ring.end());
  return out;
}

Surroundings::Surroundings(const SkyGrid& grid, const std::vector<std::size_t>& ring,
                           const glm::vec3& middle)
    : frame_(frame_about(middle)) {
  double weights = 0;
  glm::dvec2 center(0);
  glm::dvec3 mean(0);
  least_ = glm::vec3(INFINITY), most_ = glm::vec3(-INFINITY);
  for (const std::size_t i : ring) {
    const Environment::Patch& patch = grid.patches[i];
    const glm::vec3 color = patch.power / patch.solid_angle;
    weights += double(patch.solid_angle);
    center += glm::dvec2(patch.solid_angle * glm::vec2(patch.direction * frame_));
    mean += glm::dvec3(patch.power);
    least_ = glm::min(least_, color), most_ = glm::max(most_, color);
  }
  center /= weights, mean /= weights;
  double xx = kLeastSpread, yy = kLeastSpread, xy = 0;
  glm::dvec3 along_x(0), along_y(0);
  for (const std::size_t i : ring) {
    const Environment::Patch& patch = grid.patches[i];
    const double weight = double(patch.solid_angle) / weights;
    const glm::dvec2 at = glm::dvec2(glm::vec2(patch.direction * frame_)) - center;
    const glm::dvec3 off = glm::dvec3(patch.power / patch.solid_angle) - mean;
    xx += weight * at.x * at.x, yy += weight * at.y * at.y, xy += weight * at.x * at.y;
    along_x += weight * at.x * off, along_y += weight * at.y * off;
  }
  const double determinant = xx * yy - xy * xy;
  center_ = glm::vec2(center), mean_ = glm::vec3(mean);
  right_ = glm::vec3((yy * along_x - xy * along_y) / determinant);
  up_ = glm::vec3((xx * along_y - xy * along_x) / determinant);
}

glm::vec3 Surroundings::operator()(const glm::vec3& d) const {
  const glm::vec2 at = glm::vec2(d * frame_) - center_;
  return glm::clamp(mean_ + at.x * right_ + at.y * up_, least_, most_);
}

}  // namespace ssdo
