// SPDX-License-Identifier: Apache-2.0
#include "metrics/pareto.h"

#include <gmock/gmock.h>

#include <cmath>

namespace ssdo::test::pareto_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(Pareto, TheFrontIsWhatNothingBeatsInBoth) {
  //                                    0       1       2       3       4
  const std::vector<CostAndError> all{{5, 1}, {1, 9}, {3, 4}, {4, 4}, {2, 9.5}};
  EXPECT_THAT(pareto_front(all), ElementsAre(1, 2, 0));
}

TEST(Pareto, OfEqualOnesTheFirst) {
  EXPECT_THAT(pareto_front({{1, 2}, {1, 2}}), ElementsAre(0));
  EXPECT_THAT(pareto_front({{1, 3}, {1, 2}}), ElementsAre(1)) << "as cheap, and better";
  EXPECT_THAT(pareto_front({{2, 2}, {1, 2}}), ElementsAre(1)) << "as good, and cheaper";
}

TEST(Pareto, WhatHasNoErrorIsNotChosen) {
  const std::vector<CostAndError> all{{1, NAN}, {2, 3}, {1, INFINITY}};
  EXPECT_THAT(pareto_front(all), ElementsAre(1));
  EXPECT_THAT(pareto_front({{1, NAN}}), IsEmpty());
  EXPECT_EQ(cheapest_within(all, 1e9), 1u);
  EXPECT_EQ(cheapest_within({{1, NAN}}, 1e9), std::nullopt);
  EXPECT_EQ(least_error({{1, NAN}}), std::nullopt);
}

TEST(Pareto, TheCheapestWithinABound) {
  const std::vector<CostAndError> all{{5, 1}, {1, 9}, {3, 4}, {4, 2}};
  EXPECT_EQ(cheapest_within(all, 4), 2u) << "the bound itself counts";
  EXPECT_EQ(cheapest_within(all, 3.9), 3u);
  EXPECT_EQ(cheapest_within(all, 100), 1u);
  EXPECT_EQ(cheapest_within(all, 0.9), std::nullopt);
  EXPECT_EQ(least_error(all), 0u);
  EXPECT_EQ(least_error({{2, 1}, {1, 1}}), 1u);
}

}  // namespace
}  // namespace ssdo::test::pareto_test
