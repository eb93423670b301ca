// SPDX-License-Identifier: Apache-2.0
//
// Two numbers in the space of one float: the upper 16 bits of each, rounded so that means have no
// bias; an error of 0.2 % at most. The lower bits of both fit into another float.
#pragma once

#include <bit>
#include <cstdint>
#include <glm/vec2.hpp>

namespace ssdo {

inline constexpr std::uint32_t kFirstOfTwo = 0xffff0000u;

/// Added to the bits of a float before the lower 16 are cut off, so that the float is rounded.
inline constexpr std::uint32_t kHalfOfCut = 0x8000u;

inline float two_in_one(float first, float second) {
  const auto rounded = [](float x) { return std::bit_cast<std::uint32_t>(x) + kHalfOfCut; };
  return std::bit_cast<float>((rounded(first) & kFirstOfTwo) | rounded(second) >> 16);
}
inline float first_of_two(float both) {
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(both) & kFirstOfTwo);
}
inline float second_of_two(float both) {
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(both) << 16);
}

/// What two_in_one() loses of each number: 16 signed bits, to be added to the bits of its float.
inline float rest_of_two(float first, float second) {
  const auto rest = [](float x) {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    return bits - ((bits + kHalfOfCut) & kFirstOfTwo);
  };
  return std::bit_cast<float>(rest(first) << 16 | (rest(second) & ~kFirstOfTwo));
}

/// The two numbers in full, from two_in_one() and rest_of_two().
inline glm::vec2 with_rest(float both, float rest) {
  const auto with = [](float upper, std::uint32_t lower) {
    const auto sixteen = std::uint32_t(std::int32_t(std::int16_t(lower)));
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(upper) + sixteen);
  };
  const auto bits = std::bit_cast<std::uint32_t>(rest);
  return {with(first_of_two(both), bits >> 16), with(second_of_two(both), bits & ~kFirstOfTwo)};
}

}  // namespace ssdo
