// SPDX-License-Identifier: Apache-2.0
#include "estimators/view_space/point_kernel.h"

#include <glm/geometric.hpp>

#include "math/sequence_numbers.h"

namespace ssdo {
namespace {

/// The noise has a stream of its own, so that it stays when the number of samples changes.
constexpr unsigned kNoiseStream = 0x5eed0001u;

}  // namespace

float RandomNumbers::operator()() { return float(start_of(next_++)); }

std::vector<glm::vec3> point_kernel(int count, float least, bool random_lengths, unsigned seed) {
  RandomNumbers random(seed);
  std::vector<glm::vec3> points;
  for (int i = 0; i < count; ++i) {
    const float x = random.between(-1, 1), y = random.between(-1, 1), z = random();
    const float share = float(i) / float(count);
    const float length = least + (1 - least) * share * share;
    points.push_back(glm::normalize(glm::vec3(x, y, z)) * length *
                     (random_lengths ? random() : 1.0f));
  }
  return points;
}

std::array<glm::vec3, 16> frame_noise(unsigned seed) {
  RandomNumbers random(seed ^ kNoiseStream);
  std::array<glm::vec3, 16> noise;
  for (glm::vec3& v : noise) {
    const float x = random.between(-1, 1), y = random.between(-1, 1);
    v = {x, y, 0};
  }
  return noise;
}

std::array<float, 16> coordinate(const std::array<glm::vec3, 16>& vectors, int axis) {
  std::array<float, 16> values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = vectors[i][axis];
  return values;
}

}  // namespace ssdo
