// SPDX-License-Identifier: Apache-2.0
//
// Two numbers in the room of one float: the upper 16 bits of each. They are rounded, so that means
// are right, and off by 0.2 % at most. The rest of both has room in another float.
#pragma once

#include <bit>
#include <cstdint>
#include <glm/vec2.hpp>

namespace ssdo {

inline constexpr std::uint32_t kFirstOfTwo = 0xffff0000u;

/// What is added to the bits of a float before the lower ones are cut off.
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

/// What two_in_one() leaves out of each, to be added to its bits: 16 bits with a sign.
inline float rest_of_two(float first, float second) {
  const auto rest = [](float x) {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    return bits - ((bits + kHalfOfCut) & kFirstOfTwo);
  };
  return std::bit_cast<float>(rest(first) << 16 | (rest(second) & ~kFirstOfTwo));
}

/// The whole numbers of two_in_one() and rest_of_two().
inline glm::vec2 with_rest(float both, float rest) {
  const auto with = [](float upper, std::uint32_t lower) {
    const auto sixteen = std::uint32_t(std::int32_t(std::int16_t(lower)));
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(upper) + sixteen);
  };
  const auto bits = std::bit_cast<std::uint32_t>(rest);
  return {with(first_of_two(both), bits >> 16), with(second_of_two(both), bits & ~kFirstOfTwo)};
}

}  // namespace ssdo
