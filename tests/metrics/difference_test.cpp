// SPDX-License-Identifier: Apache-2.0
#include "metrics/difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ssdo::test::difference_test {
namespace {

const auto kEverywhere = [](int, int) { return true; };

TEST(Difference, OfFourValuesByHand) {
  const Difference d = measure_difference({1, 2, 3, -5}, {1, 1, 1, -1});
  EXPECT_EQ(d.count, 4u);
  EXPECT_DOUBLE_EQ(d.rmse, std::sqrt(21.0 / 4));
  EXPECT_DOUBLE_EQ(d.bias, -0.25);
  EXPECT_EQ(d.largest, 4);
  EXPECT_EQ(d.p99, 4);
  EXPECT_DOUBLE_EQ(d.mean_b, 0.5);
  EXPECT_DOUBLE_EQ(d.relative_rmse(), 2 * d.rmse);
  EXPECT_EQ(d.peak, 5);
  EXPECT_DOUBLE_EQ(d.psnr(), 20 * std::log10(5 / d.rmse));
}

TEST(Difference, P99LeavesOutOneOfAHundred) {
  std::vector<float> a(100, 0.5f);
  const std::vector<float> b = a;
  a[17] = 3;
  EXPECT_EQ(measure_difference(a, b).p99, 0);
  a[18] = 1;
  EXPECT_EQ(measure_difference(a, b).p99, 0.5);
  EXPECT_EQ(measure_difference(a, b).largest, 2.5);
}

TEST(Difference, OfEqualValuesIsNone) {
  const Difference d = measure_difference({0.25f, 0.5f}, {0.25f, 0.5f});
  EXPECT_EQ(d.rmse, 0);
  EXPECT_EQ(d.peak, 1) << "at least 1";
  EXPECT_EQ(d.psnr(), std::numeric_limits<double>::infinity());
  EXPECT_EQ(measure_difference({}, {}).count, 0u);
}

TEST(ChannelsDifference, CountsPixelsWithoutACounterpart) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Channels a{{0, 0, 3, 2}, {Plane<float>(3, 2, 1)}}, b{{1, 0, 4, 2}, {Plane<float>(3, 2, 0.5f)}};
  a.planes[0](1, 0) = nan;
  a.planes[0](2, 0) = b.planes[0](1, 0) = nan;
  const ChannelsDifference d = compare_channels(a, b, kEverywhere);
  EXPECT_EQ(d.left_out.outside, 4u) << "a column of each";
  EXPECT_EQ(d.left_out.in_one, 1u);
  EXPECT_EQ(d.left_out.in_both, 1u);
  EXPECT_EQ(d.pixels, 2u);
  EXPECT_EQ(d.figures.bias, 0.5);
  EXPECT_DOUBLE_EQ(d.invalid_share(), 5.0 / 7);
  EXPECT_EQ(d.a_minus_b[0](1, 1), 0.5f);
  EXPECT_EQ(d.a_minus_b[0](0, 1), 0) << "outside of B";
}

TEST(ChannelsDifference, OneChannelStandsForEach) {
  const Channels grey{{0, 0, 1, 1}, {Plane<float>(1, 1, 0.5f)}};
  const Channels color{{0, 0, 1, 1},
                       {Plane<float>(1, 1, 0.5f), Plane<float>(1, 1, 1), Plane<float>(1, 1, 1.5f)}};
  const ChannelsDifference d = compare_channels(grey, color, kEverywhere);
  EXPECT_EQ(d.figures.count, 3u);
  EXPECT_EQ(d.figures.bias, -0.5);
  EXPECT_EQ(d.a_minus_b[2][0], -1);
}

TEST(ChannelsDifference, AMaskLeavesPixelsOutWithoutCountingThem) {
  const Channels a{{0, 0, 2, 1}, {Plane<float>(2, 1, 1)}}, b{{0, 0, 2, 1}, {Plane<float>(2, 1)}};
  const ChannelsDifference d = compare_channels(a, b, [](int x, int) { return x == 1; });
  EXPECT_EQ(d.pixels, 1u);
  EXPECT_EQ(d.left_out.all(), 0u);
}

}  // namespace
}  // namespace ssdo::test::difference_test
