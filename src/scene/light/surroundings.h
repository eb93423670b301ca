// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "scene/light/sky_grid.h"
#include "scene/light/sun_region.h"

namespace ssdo {

/// The sky behind a source, guessed from a ring of patches around it: a linear function of the
/// direction, fitted to their radiance and clamped to its range.
class Surroundings {
 public:
  /// From `ring`, one patch or more around a region.
  Surroundings(const SkyGrid& grid, const std::vector<std::size_t>& ring, const glm::vec3& middle);

  /// Radiance in a unit direction.
  glm::vec3 operator()(const glm::vec3& d) const;

 private:
  glm::mat3 frame_;  ///< its third axis leads to the middle of the source
  glm::vec2 center_{0};
  glm::vec3 mean_{0}, right_{0}, up_{0}, least_{0}, most_{0};
};

/// The patches of a source with its partly covered texels, and those of the ring around it.
struct RegionAndRing {
  std::vector<std::size_t> patches, ring;
};

/// Adds to a region the patches that fall off from it, and finds a ring of a degree around both.
RegionAndRing widen(const SkyGrid& grid, const SunRegion& region);

}  // namespace ssdo
