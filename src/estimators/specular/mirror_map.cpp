// SPDX-License-Identifier: Apache-2.0
#include "estimators/specular/mirror_map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <utility>

#include "math/octahedral_map.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

/// A cell of 0.18 degrees, that of the maps which light is modelled from (map_reduction.h).
constexpr int kMostCells = 1024;
constexpr int kLeastCells = 2;

int finest_cells(const Environment& environment) {
  if (environment.is_constant()) return kLeastCells;
  const int width = std::max(environment.map()->width, kLeastCells);
  return std::min(int(std::bit_ceil(unsigned(width))), kMostCells);
}

/// Where a node lies that is a step beyond the edge of the square: the edges are folded together.
std::pair<int, int> folded(int x, int y, int last) {
  if (x < 0 || x > last) x = x < 0 ? -x : 2 * last - x, y = last - y;
  if (y < 0 || y > last) y = y < 0 ? -y : 2 * last - y, x = last - x;
  return {x, y};
}

float manhattan(const glm::vec3& d) { return std::abs(d.x) + std::abs(d.y) + std::abs(d.z); }

}  // namespace

MirrorMap::MirrorMap(const Environment& environment, const glm::mat3& world_to_camera) {
  int count = 0;
  for (int cells = finest_cells(environment); cells >= kLeastCells; cells /= 2) {
    levels_.push_back({cells + 1, count});
    count += (cells + 1) * (cells + 1);
  }
  nodes_.resize(std::size_t(count));
  const glm::mat3 to_world = glm::transpose(world_to_camera);
  const auto direction = [](const Level& level, int x, int y) {
    return octahedral_decode(glm::vec2(x, y) / float(level.size - 1));
  };
  const Level& finest = levels_.front();
  for_each_row(finest.size, [&](int y) {
    for (int x = 0; x < finest.size; ++x)
      at(finest, x, y) = environment.radiance(to_world * direction(finest, x, y));
  });
  // The mean of 3 x 3 nodes by 1 2 1, each by its part of the sphere.
  for (std::size_t k = 1; k < levels_.size(); ++k) {
    const Level &fine = levels_[k - 1], &coarse = levels_[k];
    for_each_row(coarse.size, [&](int y) {
      for (int x = 0; x < coarse.size; ++x) {
        glm::vec3 sum(0);
        float weights = 0;
        for (int dy = -1; dy <= 1; ++dy) {
          for (int dx = -1; dx <= 1; ++dx) {
            const auto [fx, fy] = folded(2 * x + dx, 2 * y + dy, fine.size - 1);
            const float l = manhattan(direction(fine, fx, fy));
            const float weight = l * l * l * float((2 - std::abs(dx)) * (2 - std::abs(dy)));
            sum += weight * at(fine, fx, fy);
            weights += weight;
          }
        }
        at(coarse, x, y) = sum / weights;
      }
    });
  }
}

float MirrorMap::level_of(float solid_angle, const glm::vec3& direction) const {
  // A step in the square covers the more of the sphere the nearer to the middle of a face.
  const float l = manhattan(direction);
  const float ratio = solid_angle / (solid_angle_of_finest(*this) * l * l * l);
  const float log2 = float(std::bit_cast<std::int32_t>(ratio)) * 0x1p-23f - 127;
  return std::clamp(0.5f * log2, 0.0f, float(levels_.size() - 1));
}

glm::vec3 MirrorMap::look_up(const Level& level, const glm::vec3& direction) const {
  const glm::vec2 place = octahedral_encode(direction) * float(level.size - 1);
  const int x = std::clamp(int(place.x), 0, level.size - 2),
            y = std::clamp(int(place.y), 0, level.size - 2);
  const glm::vec2 f = place - glm::vec2(x, y);
  const glm::vec3* row = &nodes_[std::size_t(level.first + y * level.size + x)];
  const glm::vec3* next = row + level.size;
  return glm::mix(glm::mix(row[0], row[1], f.x), glm::mix(next[0], next[1], f.x), f.y);
}

glm::vec3 MirrorMap::operator()(const glm::vec3& direction, float solid_angle) const {
  const float level = level_of(solid_angle, direction);
  const int last = int(levels_.size()) - 1, k = std::min(int(level), last),
            next = std::min(k + 1, last);
  return glm::mix(look_up(levels_[std::size_t(k)], direction),
                  look_up(levels_[std::size_t(next)], direction), level - float(k));
}

}  // namespace ssdo
