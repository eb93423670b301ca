// SPDX-License-Identifier: Apache-2.0
//
// Shares in 16 bits, alone and in vectors of every instruction set.
#include "math/fixed_ratio16.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/chosen_isa.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/fixed_ratio16_test.cpp"
#include <hwy/foreach_target.h>

#include "simd/fixed_ratio16-inl.h"

#ifndef SSDO_SHARE16_TEST_COUNT_
#define SSDO_SHARE16_TEST_COUNT_
namespace ssdo::test {
constexpr int kShares = 64 * kMostLanes;
}
#endif

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

void there_and_back(const float* from, FixedRatio16* stored, float* back) {
  for (int i = 0; i < test::kShares; i += kLanes) {
    store(load(from + i), stored + i);
    store(load(stored + i), back + i);
  }
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(there_and_back);

namespace test {
namespace {

TEST(FixedRatio16, KeepsNoiseBeyondNoneAndAll) {
  for (const float exact : {0.0f, 1.0f, 0.5f, -0.25f, 1.25f, 3.0f / 8192})
    EXPECT_EQ(float(FixedRatio16(exact)), exact);
  EXPECT_EQ(float(FixedRatio16(0.6f / 8192)), 1.0f / 8192) << "the nearest";
  for (const float beyond : {4.0f, 1e30f, INFINITY}) {
    EXPECT_EQ(float(FixedRatio16(beyond)), FixedRatio16::kMost);
    EXPECT_EQ(float(FixedRatio16(-beyond)), -FixedRatio16::kMost);
  }
}

TEST(FixedRatio16, IsTheSameInVectors) {
  std::mt19937 random(3);
  std::normal_distribution<float> noisy(0.5f, 1.5f);
  float shares[kShares], back[kShares];
  FixedRatio16 stored[kShares];
  for (float& share : shares) share = noisy(random);
  shares[0] = 1e30f, shares[1] = -1e30f, shares[2] = 1;
  for (const char* name : kIsas) {
    if (!has_isa(name)) continue;
    const ChosenIsa isa(name);
    HWY_DYNAMIC_DISPATCH(there_and_back)(shares, stored, back);
    for (int i = 0; i < kShares; ++i) {
      EXPECT_EQ(float(stored[i]), float(FixedRatio16(shares[i]))) << name << " " << shares[i];
      EXPECT_EQ(back[i], float(stored[i])) << name;
    }
  }
}

}  // namespace
}  // namespace test
}  // namespace ssdo
#endif
