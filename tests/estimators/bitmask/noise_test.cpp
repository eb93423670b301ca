// SPDX-License-Identifier: Apache-2.0
//
// What another seed changes of filtered light at standard quality: noise that is seen as soft
// clouds as wide as the pattern.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <map>
#include <vector>

#include "estimators/bitmask/request.h"
#include "estimators/bitmask/slice_pattern.h"
#include "filters/registry.h"
#include "filters/shares.h"
#include "scene/light/painted_map.h"
#include "support/boxes.h"

namespace ssdo::test {
namespace {

const Window kWindow{0, 0, 240, 160};

/// The filtered direct light of a seed.
Plane<float> light(const Geometry& g, const Environment& map, unsigned seed) {
  Scene scene = scene_of(g, map);
  scene.solids = guess_solids(g);
  Products out = bitmask_method().estimate(scene,
                                           {.products = {.ao = true, .direct = true},
                                            .radius = kNoLimit,
                                            .seed = seed,
                                            .slices = 2,
                                            .steps = 16},
                                           {});
  out = filter_shares(find_filter("geometry"), std::move(out), scene, 8);
  auto red = Plane<float>::like(out.ao);
  for (std::size_t i = 0; i < red.size(); ++i) red[i] = out.direct[i].x;
  return red;
}

/// What a seed is off the mean of many, as a root mean square over that mean.
double noise(const Geometry& g, const Environment& map) {
  constexpr int kSeeds = 8;
  std::vector<Plane<float>> of_seeds;
  for (unsigned k = 0; k < kSeeds; ++k) of_seeds.push_back(light(g, map, 256 * k));
  double variance = 0, sum = 0;
  const std::size_t pixels = of_seeds[0].size();
  for (std::size_t i = 0; i < pixels; ++i) {
    double mean = 0;
    for (const Plane<float>& of_seed : of_seeds) mean += double(of_seed[i]) / kSeeds;
    for (const Plane<float>& of_seed : of_seeds)
      variance += std::pow(double(of_seed[i]) - mean, 2) / (kSeeds - 1);
    sum += mean;
  }
  return std::sqrt(variance / double(pixels)) / (sum / double(pixels));
}

/// A sample at the end of a direction stands for neighbouring directions and distances alike, if
/// those of neighbouring directions lie at other distances.
TEST(BitmaskNoise, NeighbouringDirectionsHaveSamplesAtOtherDistances) {
  const Window window{0, 0, 4000, 900};
  const double diagonal = std::hypot(4000, 900);
  const Interleaving layout(window.width(), window.height(), 0);
  const SlicePattern pattern(layout, window, 1, 1, 0);
  std::map<double, double> start_by_angle;
  for (int m = 0; m < Interleaving::kPeriod * Interleaving::kPeriod; ++m) {
    const Slice& slice = pattern.member(m % Interleaving::kPeriod, m / Interleaving::kPeriod)[0];
    ASSERT_FALSE(slice.sides[0].steps.empty());
    const SliceStep& step = slice.sides[0].steps[0];
    const double distance = std::hypot(step.dx, step.dy);
    // The inverse of march_distance(), by bisection.
    double low = 0, high = 1;
    for (int i = 0; i < 40; ++i)
      (march_distance((low + high) / 2, diagonal) < distance ? low : high) = (low + high) / 2;
    start_by_angle[std::atan2(slice.dy, slice.dx)] = low;
  }
  ASSERT_EQ(start_by_angle.size(), 64u);
  int compared = 0;
  for (auto it = start_by_angle.begin(); std::next(it) != start_by_angle.end(); ++it) {
    const double one = it->second, other = std::next(it)->second;
    if (std::min(one, other) < 0.3) continue;  // nearer ones are moved by rounding to pixels
    EXPECT_GT(std::abs(one - other), 0.2) << "at " << it->first;
    compared += 1;
  }
  EXPECT_GT(compared, 15);
}

TEST(BitmaskNoise, OfAWidePenumbra) {
  const Surface scene = all_of({plane({}, {0, 0, 1}), Box{{-2, 0, 0}, {2, 0.2, 1.2}}.surface()});
  const Camera camera =
      look_at(camera_from_fov(50, kWindow, 1), {0, -6, 4}, {0, -0.5, 0}, {0, 0, 1});
  const glm::vec3 to = glm::normalize(glm::vec3(0.3f, 0.8f, 0.8f));
  const Environment map = paint(
      512, [&](const glm::vec3& d) { return glm::vec3(in_disc(d, to, 20) ? 8 : 0); }, 2);
  const double found = noise(geometry_of(scene, camera, kWindow), map);
  fmt::print("noise of a wide penumbra: {:.4f}\n", found);
  EXPECT_LT(found, 0.014);
}

}  // namespace
}  // namespace ssdo::test
