// SPDX-License-Identifier: Apache-2.0
#include "scene/light/sun_region.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <utility>

#include "scene/light/distant_source.h"

namespace ssdo {
namespace {

constexpr int kSteps = 10;                ///< down to 1/32 of the peak
const float kStep = 1 / std::sqrt(2.0f);  ///< from one threshold to the next
constexpr float kLeastGrowth = 1.2f;      ///< of what is missing: steps that add less add glow
constexpr int kIdleSteps = 2;             ///< that many steps halve the threshold

/// The radius of a piece of a longer region, about its start, and how often a piece is grown anew
/// from its middle: one that starts at an end of a band would be half as long.
const float kPieceRadius = glm::radians(36.0f);
constexpr int kNewStarts = 3;

/// The width, in patches, of the fringe between a piece and the rest of the region that it is cut
/// from.
constexpr int kBesidePiece = 4;

/// Shares of a piece's light that harmonics miss: at kLeastMissing the piece stays in the map, and
/// at kMostlyMissing it is taken out whole. Of bands along the horizon of 6, 11, 16 and 18 degrees
/// they miss 0.82, 0.67, 0.51 and 0.44; direct light on low boxes under one of 22 is as good with
/// harmonics alone.
constexpr float kLeastMissing = 0.45f, kMostlyMissing = 0.65f;

/// The first threshold that a radiance reaches; kSteps for none of them.
int step_of(float radiance, float peak) {
  if (!(radiance > 0)) return kSteps;
  const float steps = std::ceil(std::log2(peak / radiance) * 2 - 1 - 1e-3f);
  return int(std::clamp(steps, 0.0f, float(kSteps)));
}

}  // namespace

SunGrowth::SunGrowth(const SkyGrid& grid, ShRadiance sh_radiance)
    : grid_(grid),
      sh_radiance_(std::move(sh_radiance)),
      reached_(grid.patches.size()),
      by_piece_(grid.patches.size()) {}

/// Adds the patches that the threshold of `step` reaches. Returns whether the region may still be a
/// source.
bool SunGrowth::flood(int step, const glm::vec3& start, Sums& sums) {
  const double most = 2 * glm::pi<double>() * (1 - std::cos(double(kMostSunRadius)));
  const float farthest = std::cos(is_piece_ ? kPieceRadius : 2 * kMostSunRadius);
  std::vector<std::size_t>& open = border_[std::size_t(step)];
  while (!open.empty()) {
    const std::size_t at = open.back();
    open.pop_back();
    patches_.push_back(at);
    const Environment::Patch& patch = grid_.patches[at];
    const float power = brightness(patch.power);
    sums.light += glm::dvec3(power * patch.direction);
    sums.power += double(power);
    sums.missing += double(power - sh_radiance_(at) * patch.solid_angle);
    sums.solid_angle += double(patch.solid_angle);
    if (sums.solid_angle > most || glm::dot(patch.direction, start) < farthest) return false;
    grid_.for_each_neighbour(at, [&](std::size_t next) {
      if (reached_[next]) return;
      if (is_piece_ && glm::dot(grid_.patches[next].direction, start) < farthest) return;
      reached_[next] = true;
      const int taken_by = step_of(grid_.radiance(next), peak_);
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

std::optional<SunRegion> SunGrowth::grow(std::size_t seed, const LeastMissing& least) {
  peak_ = grid_.radiance(seed);
  if (!(peak_ > 0)) return std::nullopt;
  is_piece_ = false;
  std::optional<SunRegion> region = grow_from(seed, least);
  if (!region) return too_wide_ ? grow_piece(seed, least) : region;
  const auto& patches = region->patches;
  if (std::any_of(patches.begin(), patches.end(), [&](std::size_t p) { return by_piece_[p]; }))
    region->weight = piece_weight_;
  return region;
}

void SunGrowth::mark_around(const SunRegion& piece) {
  std::vector<std::size_t> edge = piece.patches, next;
  for (const std::size_t patch : edge) by_piece_[patch] = true;
  for (int i = 0; i < kBesidePiece; ++i, edge.swap(next)) {
    next.clear();
    for (const std::size_t from : edge) {
      grid_.for_each_neighbour(from, [&](std::size_t to) {
        if (!by_piece_[to]) next.push_back(to);
        by_piece_[to] = true;
      });
    }
  }
}

std::optional<SunRegion> SunGrowth::grow_piece(std::size_t seed, const LeastMissing& least) {
  is_piece_ = true;
  std::optional<SunRegion> region = grow_from(seed, least);
  for (int i = 0; i < kNewStarts && region; ++i) {
    const auto& patches = region->patches;
    const std::size_t start =
        *std::max_element(patches.begin(), patches.end(), [&](std::size_t a, std::size_t b) {
          return glm::dot(grid_.patches[a].direction, region->middle) <
                 glm::dot(grid_.patches[b].direction, region->middle);
        });
    region = grow_from(start, least);
  }
  if (!region) return region;
  const float missing = region->missing / region->light;
  region->weight =
      std::clamp((missing - kLeastMissing) / (kMostlyMissing - kLeastMissing), 0.0f, piece_weight_);
  // All pieces of a band are alike, but harmonics hold less of each next one: no weight may rise.
  if (region->weight > 0) {
    piece_weight_ = region->weight;
    mark_around(*region);
  }
  return region;
}

std::optional<SunRegion> SunGrowth::grow_from(std::size_t start, const LeastMissing& least) {
  too_wide_ = false;
  patches_.clear();
  border_.assign(kSteps + 1, {});
  reached_.assign(grid_.patches.size(), false);
  reached_[start] = true;
  border_[0].push_back(start);
  std::optional<SunRegion> best;
  std::size_t count = 0;
  float missing = 0;
  int idle = 0;
  Sums sums;
  for (int step = 0; step < kSteps; ++step) {
    too_wide_ = !flood(step, grid_.patches[start].direction, sums);
    if (too_wide_) break;
    SunRegion region = region_of(sums);
    if (!best && region.missing < least(region.middle)) continue;
    too_wide_ = is_wide(region.middle);
    if (too_wide_) break;
    const bool grows = region.missing > kLeastGrowth * missing;
    if (!grows && ++idle > kIdleSteps) break;
    // Its dim parts belong to a source, but not a wide surface that it stands before.
    if (!grows && region.light > kLeastGrowth * best->light) break;
    if (grows) missing = region.missing, idle = 0;
    region.threshold = grows ? peak_ * std::pow(kStep, float(step + 1)) : best->threshold;
    best = std::move(region);
    count = patches_.size();
  }
  if (best) best->patches.assign(patches_.begin(), patches_.begin() + std::ptrdiff_t(count));
  return best;
}

}  // namespace ssdo
