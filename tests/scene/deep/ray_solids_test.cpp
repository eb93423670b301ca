// SPDX-License-Identifier: Apache-2.0
//
// The rule that turns samples into solids, by hand.
#include "scene/deep/ray_solids.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace ssdo::test::ray_solids_test {
namespace {

using Samples = std::vector<DeepSample>;

/// "front-back front-back", with two decimals.
std::string solids_of(const Samples& samples, std::size_t most = 8, float far = 1e9f) {
  RaySolids ray(far);
  ray.add(samples);
  std::string text;
  for (const RaySolid& s : ray.find(most))
    text += fmt::format("{}{:.2f}-{:.2f}", text.empty() ? "" : " ", s.front, s.back);
  return text;
}

TEST(RaySolids, AreSamplesThatStopHalfOfTheLight) {
  EXPECT_EQ(solids_of({}), "");
  EXPECT_EQ(solids_of({{2, 2, 1}}), "2.00-2.00");
  EXPECT_EQ(solids_of({{2, 3, 1}}), "2.00-3.00");
  EXPECT_EQ(solids_of({{5, 5, 1}, {2, 3, 1}}), "2.00-3.00 5.00-5.00") << "in any order";
  EXPECT_EQ(solids_of({{2, 2, 0.5f}, {5, 5, 1}}), "2.00-2.00 5.00-5.00");
  EXPECT_EQ(solids_of({{2, 2, 0.49f}, {5, 5, 1}}), "5.00-5.00") << "mostly open";
  EXPECT_EQ(solids_of({{2, 2, 0.3f}, {3, 3, 0.3f}, {9, 9, 1}}), "3.00-3.00 9.00-9.00")
      << "two thin ones stop 0.51";
  EXPECT_EQ(solids_of({{2, 2, 1}, {3, 3, 0.3f}, {9, 9, 0.3f}}), "2.00-2.00 9.00-9.00")
      << "counted anew behind a solid";
}

TEST(RaySolids, OfAMediumBeginWhereHalfIsStopped) {
  // 1 - (1 - 0.9)^t = 1/2 at t = log 2 / log 10 = 0.301.
  EXPECT_EQ(solids_of({{1, 5, 0.9f}}), "2.20-5.00");
  EXPECT_EQ(solids_of({{1, 5, 0.4f}}), "");
  EXPECT_EQ(solids_of({{1, 5, 0.4f}, {3, 3, 1}}), "3.00-3.00");
  EXPECT_EQ(solids_of({{1, 5, 0.4f}, {3, 4, 1}}), "3.00-4.00");
  // ln 0.6 each: half is stopped after 1.357 of two of them, in both where they overlap.
  EXPECT_EQ(solids_of({{1, 2, 0.4f}, {2, 3, 0.4f}}), "2.36-3.00");
  EXPECT_EQ(solids_of({{1, 2, 0.4f}, {1, 2, 0.4f}}), "1.68-2.00");
  Samples fog;
  for (int i = 0; i < 50; ++i) fog.push_back({float(10 + i), float(11 + i), 0.1f});
  EXPECT_EQ(solids_of(fog), "16.58-60.00") << "one solid: ln 2 / -ln 0.9 = 6.58";
}

TEST(RaySolids, OfElementsThatOverlapAreTheirUnion) {
  EXPECT_EQ(solids_of({{2, 4, 1}, {3, 6, 1}, {6, 7, 1}, {8, 9, 1}}), "2.00-7.00 8.00-9.00");
  EXPECT_EQ(solids_of({{2, 6, 1}, {3, 3, 1}, {4, 5, 0.2f}}), "2.00-6.00");
  EXPECT_EQ(solids_of({{2, 2, 1}, {2, 2, 1}}), "2.00-2.00");
}

TEST(RaySolids, LeaveOutWhatIsNoSample) {
  const float inf = INFINITY, nan = NAN;
  EXPECT_EQ(solids_of({{nan, 1, 1}, {inf, inf, 1}, {-1, 2, 1}, {0, 0, 1}, {3, 3, 0}, {3, 3, nan}}),
            "");
  EXPECT_EQ(solids_of({{3, nan, 1}, {4, 2, 1}}), "3.00-3.00 4.00-4.00") << "no back before a front";
  EXPECT_EQ(solids_of({{3, 3, 1}, {8, 8, 1}}, 8, 8), "3.00-3.00") << "from `far` on nothing";
  EXPECT_EQ(solids_of({{3, 3, 7}}), "3.00-3.00");
  EXPECT_EQ(solids_of({{3, 3, 1}, {4, 4, 1}, {5, 5, 1}}, 2), "3.00-3.00 4.00-4.00");
}

TEST(RaySolids, DoNotDependOnTheOrderOfSamples) {
  std::mt19937 random(7);
  for (int i = 0; i < 200; ++i) {
    Samples samples;
    for (int k = 0; k < 12; ++k) {
      const float front = 1 + float(random() % 64) / 4;
      samples.push_back({front, front + float(random() % 3), float(random() % 5) / 4});
    }
    const std::string first = solids_of(samples);
    std::shuffle(samples.begin(), samples.end(), random);
    ASSERT_EQ(solids_of(samples), first);
  }
}

}  // namespace
}  // namespace ssdo::test::ray_solids_test
