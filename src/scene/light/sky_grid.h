// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "scene/light/environment.h"

namespace ssdo {

/// The patches of an environment in rows and columns, the date line and the poles at its borders.
struct SkyGrid {
  int columns = 0, rows = 0;
  std::vector<Environment::Patch> patches;

  /// At most `most_columns` x `most_columns` / 2 patches. Not for a constant.
  SkyGrid(const Environment& environment, const glm::mat3& world_to_camera, int most_columns);

  /// The same light in fewer patches.
  SkyGrid merged(int most_columns) const;

  std::size_t index(int x, int y) const {
    return std::size_t(y) * std::size_t(columns) + std::size_t(x);
  }

  /// The brightness of a patch.
  float radiance(std::size_t patch) const;

  /// Calls `visit(index)` for the eight patches around one, across the date line and the poles.
  template <class Visit>
  void for_each_neighbour(std::size_t patch, const Visit& visit) const {
    const int x = int(patch % std::size_t(columns)), y = int(patch / std::size_t(columns));
    for (int down = -1; down <= 1; ++down) {
      // Beyond a pole the grid goes on in its last row, half a turn away.
      const bool beyond = y + down < 0 || y + down >= rows;
      const int row = beyond ? y : y + down, turn = beyond ? columns / 2 : 0;
      for (int right = -1; right <= 1; ++right)
        visit(index((x + right + turn + columns) % columns, row));
    }
  }

 private:
  SkyGrid() = default;
};

}  // namespace ssdo
