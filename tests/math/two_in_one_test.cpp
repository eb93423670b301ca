// SPDX-License-Identifier: Apache-2.0
#include "math/two_in_one.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random_numbers.h"

namespace ssdo::test::two_in_one_test {
namespace {

TEST(TwoInOne, NumbersAreWholeWithTheRest) {
  RandomNumbers random(7);
  for (int i = 0; i < 100000; ++i) {
    const float first = std::ldexp(float(random.between(-1, 1)), random.whole(-60, 60)),
                second = i % 10 == 0 ? 0 : float(random.between(-1e3, 1e3));
    const float both = two_in_one(first, second), rest = rest_of_two(first, second);
    ASSERT_EQ(with_rest(both, rest), glm::vec2(first, second));
    ASSERT_NEAR(first_of_two(both), first, 0.004 * std::abs(first));
    ASSERT_NEAR(second_of_two(both), second, 0.004 * std::abs(second));
  }
}

}  // namespace
}  // namespace ssdo::test::two_in_one_test
