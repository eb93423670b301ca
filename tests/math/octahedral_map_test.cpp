// SPDX-License-Identifier: Apache-2.0
#include "math/octahedral_map.h"

#include <gtest/gtest.h>

#include <random>

namespace ssdo::test::octahedral_map_test {
namespace {

glm::vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<float> normal;
  const float x = normal(random), y = normal(random);
  return glm::normalize(glm::vec3(x, y, normal(random)));
}

TEST(OctahedralMap, DecodesWhatItEncodes) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 d = random_direction(random);
    const glm::vec2 uv = octahedral_encode(d);
    EXPECT_TRUE(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1);
    EXPECT_LT(glm::distance(octahedral_decode(uv), d), 1e-5f);
  }
}

TEST(OctahedralMap, BothSidesOfAFoldShareTheirNodes) {
  const OctahedralMap map(9);
  for (int i = 0; i < 9; ++i) {
    EXPECT_LT(glm::distance(map.direction_of(i, 0), map.direction_of(8 - i, 0)), 1e-6f);
    EXPECT_LT(glm::distance(map.direction_of(8, i), map.direction_of(8, 8 - i)), 1e-6f);
  }
}

TEST(OctahedralMap, InterpolatesEverywhereWithoutASeam) {
  OctahedralMap map(65);
  for (int y = 0; y < map.size(); ++y)
    for (int x = 0; x < map.size(); ++x) map(x, y) = map.direction_of(x, y);
  std::mt19937 random(2);
  for (int i = 0; i < 1000; ++i) {
    const glm::vec3 d = random_direction(random);
    EXPECT_LT(glm::distance(map(d), d), 0.02f) << d.x << " " << d.y << " " << d.z;
  }
  for (const glm::vec3& pole : {glm::vec3(0, 0, -1), glm::vec3(0, 0, 1), glm::vec3(-1, 0, 0)})
    EXPECT_LT(glm::distance(map(pole), pole), 1e-6f);
}

}  // namespace
}  // namespace ssdo::test::octahedral_map_test
