// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>

namespace ssdo::fuzz {

/// Decisions that a seed repeats.
class Chance {
 public:
  explicit Chance(unsigned seed) : numbers_(seed + 1) {}

  /// From 0 to `end` - 1.
  int below(int end) { return int(numbers_() % std::uint_fast32_t(end)); }
  bool one_in(int n) { return below(n) == 0; }
  float share() { return float(below(1 << 20)) / float(1 << 20); }

  template <class All>
  auto& pick(All& all) {
    return all[std::size_t(below(int(std::size(all))))];
  }

 private:
  std::minstd_rand numbers_;
};

/// Numbers at the ends of what types and checks allow.
inline constexpr std::array<float, 14> kOddFloats = {0.0f,
                                                     -0.0f,
                                                     1.0f,
                                                     -1.0f,
                                                     1e-30f,
                                                     65504.0f,
                                                     1e9f,
                                                     1e10f,
                                                     -1e10f,
                                                     1e30f,
                                                     1e38f,
                                                     1e-45f,
                                                     std::numeric_limits<float>::infinity(),
                                                     std::numeric_limits<float>::quiet_NaN()};
inline constexpr std::array<std::int32_t, 14> kOddInts = {
    0,  1,   2,     -1,      7,          16,         32,
    64, 255, 65535, 1000000, 0x3fffffff, 0x7fffffff, std::numeric_limits<std::int32_t>::min()};

}  // namespace ssdo::fuzz
