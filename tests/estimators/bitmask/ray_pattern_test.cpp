// SPDX-License-Identifier: Apache-2.0
//
// The points of a source that the rays of a pixel and of its neighbours go to.
#include "estimators/bitmask/rays/ray_pattern.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <memory>
#include <set>
#include <tuple>

#include "scene/light/light.h"
#include "support/sun_of.h"

namespace ssdo::test::ray_pattern_test {
namespace {

/// A disc of 10 degrees around the middle of the map, in the dark.
DistantSource soft_box() {
  constexpr int kWidth = 256, kHeight = 128;
  auto map = std::make_shared<Plane<glm::vec3>>(kWidth, kHeight, glm::vec3(0));
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      if (std::hypot(x + 0.5 - kWidth / 2, y + 0.5 - kHeight / 2) < 10 * kWidth / 360.0)
        (*map)(x, y) = glm::vec3(10);
  return sun_of(model_light(Environment(map, {}), glm::mat3(1)));
}

using Directions = std::vector<PointsOfSource>;

constexpr std::size_t kBlocks = std::tuple_size_v<PointsOfSource>,
                      kMembers = std::tuple_size_v<PointsOfSource::value_type>;

/// How far the mean over the rays of a pixel is off that over all, as a root mean square.
double spread_of_pixels(const Directions& directions) {
  const double rays = double(directions.size());
  std::vector<glm::dvec3> means;
  glm::dvec3 all(0);
  for (std::size_t block = 0; block < kBlocks; ++block) {
    for (std::size_t m = 0; m < kMembers; ++m) {
      glm::dvec3 mean(0);
      for (const PointsOfSource& of_ray : directions) mean += glm::dvec3(of_ray[block][m]) / rays;
      means.push_back(mean), all += mean;
    }
  }
  all /= double(means.size());
  double sum = 0;
  for (const glm::dvec3& mean : means) sum += glm::dot(mean - all, mean - all);
  return std::sqrt(sum / double(means.size()));
}

TEST(RayPattern, RaysGrowWithTheSlices) {
  EXPECT_EQ(rays_to_source(1), 1);
  EXPECT_EQ(rays_to_source(2), 1);
  EXPECT_EQ(rays_to_source(6), 2);
  EXPECT_EQ(rays_to_source(24), 8);
  EXPECT_EQ(rays_to_source(64), 32);
}

TEST(RayPattern, RaysOfAPixelAreSpreadMoreEvenlyThanByChance) {
  const DistantSource sun = soft_box();
  double before = spread_of_pixels(points_of(sun, 1, 0));
  EXPECT_GT(before, 0.05) << "the source is wide";
  for (const int rays : {2, 4, 8}) {
    const double spread = spread_of_pixels(points_of(sun, rays, 0));
    EXPECT_LT(spread, before / 1.5) << rays;  // sqrt(2) by chance
    before = spread;
  }
}

/// The part of a block's rays that go to one side of a line through the source, for the error of a
/// shadow's edge: the largest difference to that of all points of the source.
double worst_edge(const Directions& directions, const DistantSource& sun, std::size_t first,
                  std::size_t blocks) {
  const glm::dvec3 middle(sun.direction),
      side = glm::normalize(glm::cross(middle, glm::dvec3(0.3, 0.5, 0.8))),
      other = glm::cross(middle, side);
  double worst = 0;
  for (int turn = 0; turn < 16; ++turn) {
    const double angle = turn * glm::radians(22.5);
    const glm::dvec3 across = std::cos(angle) * side + std::sin(angle) * other;
    double beyond = 0, count = 0;
    for (const PointsOfSource& of_ray : directions) {
      for (std::size_t block = first; block < first + blocks; ++block) {
        for (const glm::vec3& to : of_ray[block])
          beyond += glm::dot(glm::dvec3(to), across) > 0, count += 1;
      }
    }
    worst = std::max(worst, std::abs(beyond / count - 0.5));
  }
  return worst;
}

TEST(RayPattern, EachBlockIsTheSourceAndAllAreItMoreFinely) {
  const DistantSource sun = soft_box();
  for (const int rays : {1, 2, 8}) {
    const Directions directions = points_of(sun, rays, 5);
    for (std::size_t block = 0; block < kBlocks; ++block)
      EXPECT_LT(worst_edge(directions, sun, block, 1), 0.08) << rays;
    EXPECT_LT(worst_edge(directions, sun, 0, kBlocks), 0.03) << rays;
  }
}

TEST(RayPattern, NoDirectionIsTakenTwice) {
  const DistantSource sun = soft_box();
  constexpr int kSeeds = 8, kRays = 2;
  std::set<std::tuple<float, float, float>> seen;
  std::size_t count = 0;
  const auto add = [&](const Directions& directions, std::size_t member) {
    for (const PointsOfSource& of_ray : directions) {
      for (const auto& of_block : of_ray) {
        const glm::vec3 to = of_block[member];
        seen.insert({to.x, to.y, to.z}), count += 1;
      }
    }
  };
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    add(points_of(sun, kRays, seed), 11);
    add(points_of(sun, kRays, seed, RaySet::of_error), 11);
  }
  EXPECT_EQ(count, 2 * kSeeds * kRays * kBlocks);
  EXPECT_EQ(seen.size(), count);
}

}  // namespace
}  // namespace ssdo::test::ray_pattern_test
