// SPDX-License-Identifier: Apache-2.0
#include "scene/light/sun_region.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <utility>

#include "scene/light/sun.h"

namespace ssdo {
namespace {

constexpr int kSteps = 10;                ///< down to 1/32 of the peak
const float kStep = 1 / std::sqrt(2.0f);  ///< from one threshold to the next
constexpr float kLeastGrowth = 1.2f;      ///< of what is missing: steps that add less add glow
constexpr int kIdleSteps = 2;             ///< that many steps halve the threshold

float radiance(const Environment::Patch& patch) {
  return brightness(patch.power) / patch.solid_angle;
}

/// The first threshold that a radiance reaches; kSteps for none of them.
int step_of(float radiance, float peak) {
  if (!(radiance > 0)) return kSteps;
  const float steps = std::ceil(std::log2(peak / radiance) * 2 - 1 - 1e-3f);
  return int(std::clamp(steps, 0.0f, float(kSteps)));
}

}  // namespace

SunGrowth::SunGrowth(const SkyGrid& grid, HeldRadiance held)
    : grid_(grid), held_(std::move(held)), reached_(grid.patches.size()) {}

/// Takes what the threshold of `step` reaches; whether it may still be a source.
bool SunGrowth::flood(int step, std::size_t seed, Sums& sums) {
  const double most = 2 * glm::pi<double>() * (1 - std::cos(double(kMostSunRadius)));
  const float farthest = std::cos(2 * kMostSunRadius);
  const glm::vec3 start = grid_.patches[seed].direction;
  const float peak = radiance(grid_.patches[seed]);
  std::vector<std::size_t>& open = border_[std::size_t(step)];
  while (!open.empty()) {
    const std::size_t at = open.back();
    open.pop_back();
    patches_.push_back(at);
    const Environment::Patch& patch = grid_.patches[at];
    const float power = brightness(patch.power);
    sums.light += glm::dvec3(power * patch.direction);
    sums.power += double(power);
    sums.missing += double(power - held_(at) * patch.solid_angle);
    sums.solid_angle += double(patch.solid_angle);
    if (sums.solid_angle > most || glm::dot(patch.direction, start) < farthest) return false;
    grid_.for_each_neighbour(at, [&](std::size_t next) {
      if (reached_[next]) return;
      reached_[next] = true;
      const int taken_by = step_of(radiance(grid_.patches[next]), peak);
      border_[std::size_t(std::max(step, taken_by))].push_back(next);
    });
  }
  return true;
}

SunRegion SunGrowth::region_of(const Sums& sums) const {
  SunRegion region;
  const double length = glm::length(sums.light);
  region.middle = glm::vec3(sums.light / length);
  region.light = float(length) / glm::pi<float>();
  region.missing = float(sums.missing / sums.power) * region.light;
  return region;
}

bool SunGrowth::is_wide(const glm::vec3& middle) const {
  const float most = 2 * std::sin(kMostSunRadius / 2);
  return std::any_of(patches_.begin(), patches_.end(), [&](std::size_t i) {
    // To the corner of a patch: those of a coarse map are wide themselves.
    const Environment::Patch& patch = grid_.patches[i];
    return glm::distance(patch.direction, middle) + std::sqrt(patch.solid_angle / 2) > most;
  });
}

std::optional<SunRegion> SunGrowth::grow(std::size_t seed,
                                         const std::function<float(glm::vec3)>& least) {
  const float peak = radiance(grid_.patches[seed]);
  if (!(peak > 0)) return std::nullopt;
  patches_.clear();
  border_.assign(kSteps + 1, {});
  reached_.assign(grid_.patches.size(), false);
  reached_[seed] = true;
  border_[0].push_back(seed);
  std::optional<SunRegion> best;
  std::size_t count = 0;
  float missing = 0;
  int idle = 0;
  Sums sums;
  for (int step = 0; step < kSteps && flood(step, seed, sums); ++step) {
    SunRegion region = region_of(sums);
    if (!best && region.missing < least(region.middle)) continue;
    if (is_wide(region.middle)) break;
    const bool grows = region.missing > kLeastGrowth * missing;
    if (!grows && ++idle > kIdleSteps) break;
    // Its dim parts belong to a source, but not a wide surface that it stands before.
    if (!grows && region.light > kLeastGrowth * best->light) break;
    if (grows) missing = region.missing, idle = 0;
    region.threshold = grows ? peak * std::pow(kStep, float(step + 1)) : best->threshold;
    best = std::move(region);
    count = patches_.size();
  }
  if (best) best->patches.assign(patches_.begin(), patches_.begin() + std::ptrdiff_t(count));
  return best;
}

}  // namespace ssdo
