// SPDX-License-Identifier: Apache-2.0
//
// A map of 8192 columns took more time and memory than the frame.
#include "scene/light/map_reduction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <memory>
#include <utility>

#include "scene/light/environment.h"

namespace ssdo::test::map_reduction_test {
namespace {

constexpr int kWidth = 101, kHeight = 53, kColumns = 16;

Plane<glm::vec3> some_map() {
  Plane<glm::vec3> map(kWidth, kHeight);
  for (std::size_t i = 0; i < map.size(); ++i)
    map[i] = glm::vec3(float(i * 2654435761u % 1009), float(i % 7), 1);
  return map;
}

/// By strips of `rows` rows.
Plane<glm::vec3> reduced(const Plane<glm::vec3>& map, int rows, int columns = kColumns) {
  MapReduction reduction(map.width, map.height, columns);
  for (int y = 0; y < map.height; y += rows) {
    Plane<glm::vec3> strip(map.width, std::min(rows, map.height - y));
    std::copy_n(&map(0, y), strip.size(), strip.pixels.begin());
    reduction.add(y, strip);
  }
  return reduction.take();
}

Environment around(Plane<glm::vec3> map) {
  return Environment(std::make_shared<const Plane<glm::vec3>>(std::move(map)), {});
}

TEST(MapReduction, KeepsTheLightAndItsColour) {
  const Plane<glm::vec3> map = some_map(), small = reduced(map, kHeight);
  EXPECT_EQ(small.width, 16);
  EXPECT_EQ(small.height, 8);
  const glm::vec3 before = around(map).mean(), after = around(small).mean();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(after[c] / before[c], 1, 1e-5) << c;
  for (const glm::vec3& texel : small.pixels) EXPECT_NEAR(texel.z, 1, 1e-5) << "a constant";
}

/// Wherever a texel lies, across the borders of the small map's texels too.
TEST(MapReduction, KeepsASunInItsPlace) {
  for (const auto& [x, y] : {std::pair(50, 26), {6, 20}, {100, 30}, {33, 3}}) {
    Plane<glm::vec3> map(kWidth, kHeight);
    map(x, y) = glm::vec3(1e5f);
    const Environment whole = around(map), small = around(reduced(map, 10));
    EXPECT_NEAR(small.mean().x / whole.mean().x, 1, 1e-5);
    glm::dvec3 towards(0);
    for (const Environment::Patch& patch : small.patches(glm::mat3(1), kColumns))
      towards += glm::dvec3(patch.power.x * patch.direction);
    const double off =
        glm::distance(glm::normalize(towards), glm::dvec3(whole.texel_direction(x, y)));
    EXPECT_LT(off, glm::radians(360.0) / kColumns / 2) << x << ' ' << y << ": within its texel";
  }
}

TEST(MapReduction, DoesNotDependOnTheStrips) {
  const Plane<glm::vec3> map = some_map(), whole = reduced(map, kHeight);
  for (const int rows : {1, 7, 20}) EXPECT_EQ(reduced(map, rows).pixels, whole.pixels) << rows;
}

TEST(MapReduction, LeavesSmallMapsAsTheyAre) {
  EXPECT_EQ(reduced(some_map(), 10, kWidth / 2 + 1).pixels, some_map().pixels);
}

}  // namespace
}  // namespace ssdo::test::map_reduction_test
