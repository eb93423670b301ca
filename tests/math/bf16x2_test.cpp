// SPDX-License-Identifier: Apache-2.0
#include "math/bf16x2.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random_numbers.h"

namespace ssdo::test::bf16x2_test {
namespace {

TEST(TwoInOne, NumbersAreWholeWithTheRest) {
  RandomNumbers random(7);
  for (int i = 0; i < 100000; ++i) {
    const float first = std::ldexp(float(random.between(-1, 1)), random.whole(-60, 60)),
                second = i % 10 == 0 ? 0 : float(random.between(-1e3, 1e3));
    const float both = pack_bf16x2(first, second), rest = pack_bf16x2_rest(first, second);
    ASSERT_EQ(unpack_bf16x2_exact(both, rest), glm::vec2(first, second));
    ASSERT_NEAR(unpack_bf16_first(both), first, 0.004 * std::abs(first));
    ASSERT_NEAR(unpack_bf16_second(both), second, 0.004 * std::abs(second));
  }
}

}  // namespace
}  // namespace ssdo::test::bf16x2_test
