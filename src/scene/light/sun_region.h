// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "scene/light/sky_grid.h"

namespace ssdo {

/// The largest radius of a source. Light farther from its middle belongs to the sky: harmonics hold
/// most of it.
const float kMostSunRadius = glm::radians(40.0f);

/// Patches of a grid that touch each other and are brighter than what is around them.
struct SunRegion {
  std::vector<std::size_t> patches;
  float threshold = 0;  ///< radiance that all have but the dim ones at its border
  glm::vec3 middle{0};  ///< unit, of its light
  float light = 0;      ///< irradiance over pi of a surface that faces the middle
  float missing = 0;    ///< that part of it which harmonics do not hold
  float weight = 1;     ///< 0..1, part of its light that may be taken; < 1 for pieces of a band
};

/// Radiance that harmonics hold in a patch.
using ShRadiance = std::function<float(std::size_t patch)>;

/// The least irradiance over pi that harmonics must miss of a source with this middle.
using LeastMissing = std::function<float(const glm::vec3& middle)>;

/// Finds the patches around a bright one that form a source.
class SunGrowth {
 public:
  SunGrowth(const SkyGrid& grid, ShRadiance sh_radiance);

  /// Lowers the threshold from the radiance of `seed` on, step by step, and adds what is connected.
  /// Returns the first region whose `missing` is at least `least` and to which half the threshold
  /// would add little; nothing if there is none within kMostSunRadius. Of a longer region that
  /// harmonics hardly hold, such as a bright band along the horizon, returns a piece.
  std::optional<SunRegion> grow(std::size_t seed, const LeastMissing& least);

 private:
  struct Sums {
    glm::dvec3 light{0};
    double missing = 0, power = 0, solid_angle = 0;
  };
  std::optional<SunRegion> grow_from(std::size_t start, const LeastMissing& least);
  std::optional<SunRegion> grow_piece(std::size_t seed, const LeastMissing& least);
  void mark_around(const SunRegion& piece);
  bool flood(int step, const glm::vec3& start, Sums& sums);
  bool is_wide(const glm::vec3& middle) const;
  SunRegion region_of(const Sums& sums) const;

  const SkyGrid& grid_;
  ShRadiance sh_radiance_;
  std::vector<std::size_t> patches_;              ///< of the region, as they were reached
  std::vector<std::vector<std::size_t>> border_;  ///< what touches it, by the step that takes it
  std::vector<bool> reached_;
  float peak_ = 0;              ///< radiance of the seed
  bool is_piece_ = false;       ///< what is farther than kPieceRadius from the start is left out
  bool too_wide_ = false;       ///< how growth ended
  float piece_weight_ = 1;      ///< of the pieces so far
  std::vector<bool> by_piece_;  ///< what is in one of them or beside it
};

}  // namespace ssdo
