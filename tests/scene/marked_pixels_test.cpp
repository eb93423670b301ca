// SPDX-License-Identifier: Apache-2.0
#include "scene/marked_pixels.h"

#include <gtest/gtest.h>

#include <random>

namespace ssdo::test::marked_pixels_test {
namespace {

Plane<unsigned char> random_mask(int width, int height, double share) {
  std::mt19937 random(7);
  std::bernoulli_distribution marked(share);
  Plane<unsigned char> mask(width, height);
  for (unsigned char& pixel : mask.pixels) pixel = marked(random) ? 1 : 0;
  return mask;
}

TEST(MarkedPixels, EveryNthIsTakenInTheOrderOfRows) {
  for (const double share : {0.0, 0.01, 0.5, 1.0}) {
    for (const int height : {1, 37}) {
      const Plane<unsigned char> mask = random_mask(53, height, share);
      for (const std::size_t stride : {1, 3, 64, 1000, 5000}) {
        std::vector<std::size_t> expected;
        std::size_t seen = 0;
        for (std::size_t i = 0; i < mask.size(); ++i)
          if (mask[i] != 0 && seen++ % stride == 0) expected.push_back(i);
        EXPECT_EQ(count_marked(mask), seen);
        EXPECT_EQ(every_marked(mask, stride), expected) << share << ", " << stride;
      }
    }
  }
}

}  // namespace
}  // namespace ssdo::test::marked_pixels_test
