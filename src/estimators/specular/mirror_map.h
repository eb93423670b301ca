// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "scene/light/environment.h"

namespace ssdo {

/// An environment in levels, each half as fine as the one before: its mean radiance over a solid
/// angle about a direction in camera space. Directions are those of OctahedralMap.
class MirrorMap {
 public:
  struct Level {
    int size;   ///< nodes in a row and in a column: a power of two and one
    int first;  ///< of its nodes in data()
  };

  MirrorMap(const Environment& environment, const glm::mat3& world_to_camera);

  const std::vector<Level>& levels() const { return levels_; }
  const float* data() const { return &nodes_[0].x; }

  /// The level, 0 to levels().size() - 1 and in between, whose nodes stand for so many steradians
  /// in a direction: log2 by the bits of a float, which is at most 0.09 off.
  float level_of(float solid_angle, const glm::vec3& direction) const;

  /// Between the two levels about that one. `direction` is unit.
  glm::vec3 operator()(const glm::vec3& direction, float solid_angle) const;

 private:
  glm::vec3& at(const Level& level, int x, int y) {
    return nodes_[std::size_t(level.first + y * level.size + x)];
  }
  glm::vec3 look_up(const Level& level, const glm::vec3& direction) const;

  std::vector<Level> levels_;
  std::vector<glm::vec3> nodes_;
};

/// The solid angle of the mean that a node of the finest level stands for, at an axis, if there are
/// so many cells in a row. Bilinear interpolation and the filter between levels have together the
/// variance of a square of two cells.
inline float solid_angle_of_finest(const MirrorMap& map) {
  const float cell = 2 / float(map.levels().front().size - 1);
  return 4 * cell * cell;
}

}  // namespace ssdo
