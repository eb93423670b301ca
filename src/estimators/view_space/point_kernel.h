// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

namespace ssdo {

/// Random numbers in 0..1, one after the other; the same for the same seed everywhere.
class RandomNumbers {
 public:
  explicit RandomNumbers(unsigned seed) : next_(static_cast<unsigned long long>(seed) << 32) {}
  float operator()();
  float between(float low, float high) { return low + (high - low) * (*this)(); }

 private:
  unsigned long long next_;
};

/// Random points of the unit half-ball about +z that crowd around its centre: directions of points
/// of a box of 2 x 2 x 1, so that its corners get more than their share, of length
/// least + (1 - least) (i / count)^2, times a random number in 0..1 if `random_lengths`.
std::vector<glm::vec3> point_kernel(int count, float least, bool random_lengths, unsigned seed);

/// 4 x 4 random vectors in camera space, row by row, that a tangent frame is turned to: x and y in
/// -1..1, z = 0.
std::array<glm::vec3, 16> frame_noise(unsigned seed);

/// One coordinate of each vector.
std::array<float, 16> coordinate(const std::array<glm::vec3, 16>& vectors, int axis);

}  // namespace ssdo
