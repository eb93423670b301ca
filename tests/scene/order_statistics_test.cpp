// SPDX-License-Identifier: Apache-2.0
#include "scene/order_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace ssdo::test::order_statistics_test {
namespace {

TEST(OrderStatistics, AreThoseOfTheSortedNumbers) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> exponent(-60, 60);
  std::vector<float> values = {0, 0, 1, std::numeric_limits<float>::denorm_min(),
                               std::numeric_limits<float>::infinity()};
  // More than one task counts.
  for (int i = 0; i < 600'000; ++i) values.push_back(std::exp2(exponent(random)));
  // As many that differ in their last bits alone.
  for (int i = 0; i < 1000; ++i) values.push_back(1 + 1e-6f * float(i * 7 % 1000));
  std::vector<float> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 0; i < 700; ++i) values.insert(values.begin() + std::ptrdiff_t(i), -1.0f);

  const OrderStatistics statistics(values);
  ASSERT_EQ(statistics.count(), sorted.size());
  for (std::size_t place = 0; place < sorted.size(); place += 1 + sorted.size() / 100)
    EXPECT_EQ(statistics.at(place), sorted[place]) << place;
  EXPECT_EQ(statistics.at(sorted.size() - 1), sorted.back());
}

TEST(OrderStatistics, OfNothingAreNone) {
  EXPECT_EQ(OrderStatistics({}).count(), 0u);
  const std::vector<float> negative = {-1, -0.5f};
  EXPECT_EQ(OrderStatistics(negative).count(), 0u);
}

}  // namespace
}  // namespace ssdo::test::order_statistics_test
