// SPDX-License-Identifier: Apache-2.0
//
// A march of few steps against one that visits every pixel, and where its steps are.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iterator>
#include <map>

#include "estimators/bitmask/request.h"
#include "estimators/bitmask/slice_pattern.h"

namespace ssdo::test::steps_test {
namespace {

struct Subject {
  const char* name;
  Surface surface;
  float radius;
};

/// What is cut by the radius, ends in the air, and is thinner than a step.
std::vector<Subject> scenes() {
  const Surface ground = plane({}, {0, 0, 1});
  std::vector<Surface> posts{ground};
  for (int k = -4; k <= 4; ++k) posts.push_back(sphere({0.35 * k, 0.3 * (k % 3), 0.05}, 0.05));
  return {{"wall within a radius", all_of({ground, plane({0, 1, 0}, {0, -1, 0})}), 0.8f},
          {"wall without limit", all_of({ground, plane({0, 1, 0}, {0, -1, 0})}), kNoLimit},
          {"ball", all_of({ground, sphere({0, 0, 0.6}, 0.6)}), 1.5f},
          {"beads", all_of(posts), 1.5f}};
}

TEST(BitmaskSteps, FewSeeAsMuchAsMany) {
  const Window window{0, 0, 240, 180};
  for (const Camera& projection :
       {camera_from_fov(45, window, 1), camera_from_ortho_width(4, window, 1)}) {
    const char* view = projection.orthographic ? "ortho" : "persp";
    for (const Subject& scene : scenes()) {
      const Geometry g = geometry_of(scene.surface, tilted(projection, 50), window);
      const auto ao = [&](int steps) {
        return run(g, {.radius = scene.radius, .slices = 8, .steps = steps}).ao;
      };
      const Plane<float> all = ao(4096), few = ao(12);
      double sum = 0, square = 0;
      for (std::size_t i = 0; i < all.size(); ++i) {
        const double off = few[i] - all[i];
        sum += off, square += off * off;
      }
      const double bias = sum / double(all.size()), rms = std::sqrt(square / double(all.size()));
      fmt::print("12 steps against all, {:<20} {}: bias {:+.4f}, rms {:.4f}\n", scene.name, view,
                 bias, rms);
      EXPECT_NEAR(bias, 0, 0.0025) << scene.name << ", " << view;
      EXPECT_LT(rms, 0.02) << scene.name << ", " << view;
    }
  }
}

/// A sample at the end of a direction stands for neighbouring directions and distances alike, if
/// those of neighbouring directions lie at other distances.
TEST(BitmaskSteps, NeighbouringDirectionsHaveSamplesAtOtherDistances) {
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

}  // namespace
}  // namespace ssdo::test::steps_test
