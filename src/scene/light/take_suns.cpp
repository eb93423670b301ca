// SPDX-License-Identifier: Apache-2.0
#include "scene/light/take_suns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>
#include <optional>
#include <utility>

#include "math/pi.h"
#include "math/spherical_harmonics.h"
#include "scene/light/sky_grid.h"
#include "scene/light/sun_region.h"
#include "scene/light/sun_texels.h"
#include "scene/light/surroundings.h"

namespace ssdo {
namespace {

constexpr std::size_t kMostSuns = 8;
constexpr int kMostTries = 24;       ///< bright places examined, whether sources or not
constexpr int kFineColumns = 1024;   ///< patches of 0.35 degrees, of which regions consist
constexpr int kCoarseColumns = 128;  ///< patches of 2.8 degrees, for harmonics

/// Shares of the irradiance, that is, how much darker a shadow is: a source of kLeastShare stays in
/// the map, one of kWholeShare is taken out whole. Between them a smoothly growing part is, so that
/// no shadow appears at once where a sun comes out of the haze. For light that harmonics hold,
/// kLeastShareInSh takes the place of kLeastShare.
constexpr float kLeastShare = 0.02f, kLeastShareInSh = 0.045f, kWholeShare = 0.05f;
constexpr float kLeastTaken = 0.001f;  ///< of the irradiance: less is not worth its rays

const float kExamined = glm::radians(5.0f);  ///< around a place that is no source

using Patch = Environment::Patch;

/// The part of a source of this share of the irradiance that is taken out, 0..1. Harmonics hold
/// `sh_fraction` of its light.
float part_taken(float share, float sh_fraction) {
  const float least = kLeastShare + sh_fraction * (kLeastShareInSh - kLeastShare);
  const float t = std::clamp((share - least) / (kWholeShare - least), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

/// Looks for sources in a map and removes them from it.
class SunSearch {
 public:
  explicit SunSearch(const Environment& whole)
      : whole_(whole),
        texels_(whole),
        fine_(whole, glm::mat3(1), kFineColumns),
        coarse_(fine_.merged(kCoarseColumns)),
        all_(coarse_.patches),
        examined_(coarse_.patches.size()),
        sh_radiance_(coarse_.patches.size()) {}

  SunsAndRest run();

 private:
  void project_rest();
  float irradiance_towards(const glm::vec3& d) const;
  std::optional<std::size_t> most_missing() const;
  bool may_be_source(const glm::vec3& d) const;
  std::size_t brightest_in(std::size_t coarse) const;
  std::size_t coarse_of(std::size_t fine) const;
  std::optional<DistantSource> take(const SunRegion& region);
  Window texels_of(std::size_t patch) const;

  const Environment& whole_;
  SunTexels texels_;
  SkyGrid fine_, coarse_;   ///< without the sources found so far
  std::vector<Patch> all_;  ///< with them
  std::vector<bool> examined_;
  std::vector<float> sh_radiance_;  ///< radiance that harmonics of the rest have, by coarse patch
};

void SunSearch::project_rest() {
  std::array<double, kShCount> coefficients{};
  for (const Patch& patch : coarse_.patches) {
    const std::array<float, kShCount> basis = sh_basis(patch.direction);
    const double power = double(brightness(patch.power));
    for (int i = 0; i < kShCount; ++i) coefficients[i] += double(basis[i]) * power;
  }
  for (std::size_t p = 0; p < sh_radiance_.size(); ++p) {
    const std::array<float, kShCount> basis = sh_basis(coarse_.patches[p].direction);
    sh_radiance_[p] = 0;
    for (int i = 0; i < kShCount; ++i) sh_radiance_[p] += float(coefficients[i]) * basis[i];
  }
}

/// Irradiance over pi, by the whole map, of a surface with normal `d`.
float SunSearch::irradiance_towards(const glm::vec3& d) const {
  float sum = 0;
  for (const Patch& patch : all_)
    sum += brightness(patch.power) * std::max(0.0f, glm::dot(patch.direction, d));
  return sum / kPif;
}

/// The patch whose light harmonics miss most.
std::optional<std::size_t> SunSearch::most_missing() const {
  std::optional<std::size_t> found;
  float most = 0;
  for (std::size_t i = 0; i < sh_radiance_.size(); ++i) {
    const Patch& patch = coarse_.patches[i];
    const float missing = brightness(patch.power) - sh_radiance_[i] * patch.solid_angle;
    if (examined_[i] || missing <= most) continue;
    most = missing, found = i;
  }
  return found;
}

/// Whether harmonics miss enough within reach of a source that has `d` at its border.
bool SunSearch::may_be_source(const glm::vec3& d) const {
  float missing = 0;
  for (std::size_t i = 0; i < sh_radiance_.size(); ++i) {
    const Patch& patch = coarse_.patches[i];
    if (glm::dot(patch.direction, d) < std::cos(2 * kMostSunRadius)) continue;
    missing += std::max(0.0f, brightness(patch.power) - sh_radiance_[i] * patch.solid_angle) / kPif;
  }
  return missing > kLeastShare * irradiance_towards(d);
}

std::size_t SunSearch::coarse_of(std::size_t fine) const {
  const int x = int(fine % std::size_t(fine_.columns)), y = int(fine / std::size_t(fine_.columns));
  return coarse_.index(x * coarse_.columns / fine_.columns, y * coarse_.rows / fine_.rows);
}

std::size_t SunSearch::brightest_in(std::size_t coarse) const {
  const int x = int(coarse % std::size_t(coarse_.columns)),
            y = int(coarse / std::size_t(coarse_.columns));
  const auto first = [](int cell, int cells, int parts) {
    return (cell * parts + cells - 1) / cells;
  };
  std::size_t best =
      fine_.index(first(x, coarse_.columns, fine_.columns), first(y, coarse_.rows, fine_.rows));
  const auto radiance = [&](std::size_t i) {
    return brightness(fine_.patches[i].power) / fine_.patches[i].solid_angle;
  };
  for (int v = first(y, coarse_.rows, fine_.rows); v < first(y + 1, coarse_.rows, fine_.rows);
       ++v) {
    for (int u = first(x, coarse_.columns, fine_.columns);
         u < first(x + 1, coarse_.columns, fine_.columns); ++u) {
      if (radiance(fine_.index(u, v)) > radiance(best)) best = fine_.index(u, v);
    }
  }
  return best;
}

Window SunSearch::texels_of(std::size_t patch) const {
  const auto first = [](int cell, int cells, int texels) {
    return int(std::int64_t(cell) * texels / cells);
  };
  const int x = int(patch % std::size_t(fine_.columns)),
            y = int(patch / std::size_t(fine_.columns));
  return {first(x, fine_.columns, texels_.width()), first(y, fine_.rows, texels_.height()),
          first(x + 1, fine_.columns, texels_.width()), first(y + 1, fine_.rows, texels_.height())};
}

/// Takes the light by which a region exceeds the sky around it out of the map, or a part of this
/// light if it is little of the irradiance there; the search goes on without any of it. Returns
/// nothing, with the map unchanged, if too little would be taken.
std::optional<DistantSource> SunSearch::take(const SunRegion& region) {
  const RegionAndRing parts = widen(fine_, region);
  if (parts.ring.empty()) return std::nullopt;
  const Surroundings around(fine_, parts.ring, region.middle);
  std::vector<Window> windows;
  for (const std::size_t patch : parts.patches) windows.push_back(texels_of(patch));
  std::optional<DistantSource> sun = texels_.measure(windows, region.threshold, around);
  if (!sun) return std::nullopt;
  const float all = irradiance_towards(sun->direction);
  const float light = std::min(brightness(sun->irradiance), region.missing);
  sun->sh_fraction = std::clamp(1 - region.missing / region.light, 0.0f, 1.0f);
  const float part = region.weight * part_taken(light / all, sun->sh_fraction);
  sun->irradiance *= part;
  sun->share = brightness(sun->irradiance) / all;
  if (!(sun->share > kLeastTaken)) return std::nullopt;
  const std::vector<glm::vec3> lost = texels_.remove(windows, around, part);
  for (std::size_t i = 0; i < parts.patches.size(); ++i) {
    fine_.patches[parts.patches[i]].power -= lost[i];
    coarse_.patches[coarse_of(parts.patches[i])].power -= lost[i];
  }
  return sun;
}

SunsAndRest SunSearch::run() {
  std::vector<DistantSource> suns;
  project_rest();
  SunGrowth growth(fine_, [&](std::size_t patch) { return sh_radiance_[coarse_of(patch)]; });
  for (int i = 0; i < kMostTries && suns.size() < kMostSuns; ++i) {
    const std::optional<std::size_t> place = most_missing();
    if (!place) break;
    const glm::vec3 d = coarse_.patches[*place].direction;
    std::optional<SunRegion> region;
    if (may_be_source(d)) {
      region = growth.grow(brightest_in(*place), [&](const glm::vec3& middle) {
        return kLeastShare * irradiance_towards(middle);
      });
    }
    const std::optional<DistantSource> sun = region ? take(*region) : std::nullopt;
    if (sun) {
      suns.push_back(*sun);
      project_rest();
      continue;
    }
    for (std::size_t p = 0; p < examined_.size(); ++p) {
      if (glm::dot(coarse_.patches[p].direction, d) >= std::cos(kExamined)) examined_[p] = true;
    }
    examined_[*place] = true;
  }
  if (suns.empty()) return {{}, whole_};
  std::sort(suns.begin(), suns.end(), [](const DistantSource& a, const DistantSource& b) {
    return brightness(a.irradiance) > brightness(b.irradiance);
  });
  return {std::move(suns), Environment(texels_.rest(), whole_.frame())};
}

}  // namespace

SunsAndRest take_suns(const Environment& whole) { return SunSearch(whole).run(); }

}  // namespace ssdo
