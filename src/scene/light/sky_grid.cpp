// SPDX-License-Identifier: Apache-2.0
#include "scene/light/sky_grid.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "scene/light/distant_source.h"

namespace ssdo {
namespace {

/// Over the sphere, without signs; at least what has a reciprocal.
float mean_brightness(const std::vector<Environment::Patch>& patches) {
  double sum = 0, solid_angle = 0;
  for (const Environment::Patch& patch : patches) {
    sum += std::abs(brightness(patch.power));
    solid_angle += patch.solid_angle;
  }
  return std::max(std::numeric_limits<float>::min(), float(sum / solid_angle));
}

}  // namespace

SkyGrid::SkyGrid(const Environment& environment, const glm::mat3& world_to_camera, int most_columns)
    : columns(std::min(environment.map()->width, most_columns)),
      patches(environment.patches(world_to_camera, most_columns)) {
  rows = int(patches.size()) / columns;
}

SkyGrid SkyGrid::merged(int most_columns) const {
  constexpr float kLeastWeight = 1e-6f;  // of black patches, in proportion to the others
  const float per_brightness = 1 / mean_brightness(patches);
  SkyGrid out;
  out.columns = std::min(columns, most_columns);
  out.rows = std::min(rows, std::max(1, most_columns / 2));
  out.patches.resize(std::size_t(out.columns) * std::size_t(out.rows));
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const Environment::Patch& part = patches[index(x, y)];
      Environment::Patch& whole =
          out.patches[out.index(x * out.columns / columns, y * out.rows / rows)];
      whole.direction +=
          (std::abs(brightness(part.power)) * per_brightness + kLeastWeight * part.solid_angle) *
          part.direction;
      whole.power += part.power;
      whole.solid_angle += part.solid_angle;
    }
  }
  for (Environment::Patch& patch : out.patches) patch.direction = glm::normalize(patch.direction);
  return out;
}

float SkyGrid::radiance(std::size_t patch) const {
  return brightness(patches[patch].power) / patches[patch].solid_angle;
}

}  // namespace ssdo
