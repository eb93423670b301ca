// SPDX-License-Identifier: Apache-2.0
#include "math/half_color.h"

#include <gtest/gtest.h>
#include <half.h>

#include <bit>
#include <cmath>
#include <cstdint>

namespace ssdo::test::half_color_test {
namespace {

/// Every number that half can hold without being denormal, and those close to halfway between two.
TEST(HalfColor, IsTheNearestHalf) {
  int checked = 0;
  for (std::uint32_t bits = 0x0400; bits < 0x7bff; ++bits) {
    const float exact = std::bit_cast<float>(bits << 13) * 0x1p112f,
                next = std::bit_cast<float>((bits + 1) << 13) * 0x1p112f;
    for (const float share : {0.0f, 0.3f, 0.4999f, 0.5f, 0.5001f, 0.9f}) {
      const float value = exact + share * (next - exact);
      const HalfColor color(glm::vec3(value, 0, value));
      ASSERT_EQ(color.r, half(value).bits()) << value;
      ASSERT_EQ(glm::vec3(color), glm::vec3(float(half(value)), 0, float(half(value))));
      ++checked;
    }
  }
  EXPECT_EQ(checked, 6 * 30719);
}

TEST(HalfColor, IsNeitherNegativeNorInfinite) {
  EXPECT_EQ(glm::vec3(HalfColor({NAN, -1, INFINITY})), glm::vec3(0, 0, 65504));
  EXPECT_EQ(glm::vec3(HalfColor({65504, 1e15f, 65519})), glm::vec3(65504));
}

TEST(HalfColor, KeepsWhatIsDark) {
  const float step = 0x1p-24f;
  const glm::vec3 found = HalfColor({1.2f * step, 100.4f * step, 0.4f * step});
  EXPECT_EQ(found, step * glm::vec3(1, 100, 0));
}

}  // namespace
}  // namespace ssdo::test::half_color_test
