// SPDX-License-Identifier: Apache-2.0
//
// Two numbers in the space of one float: the upper 16 bits of each, rounded so that means have no
// bias; an error of 0.2 % at most. The lower bits of both fit into another float.
#pragma once

#include <bit>
#include <cstdint>
#include <glm/vec2.hpp>

namespace ssdo {

inline constexpr std::uint32_t kUpperHalf = 0xffff0000u;

/// Added to the bits of a float before the lower 16 are cut off, so that the float is rounded.
inline constexpr std::uint32_t kRoundToUpperHalf = 0x8000u;

inline float pack_bf16x2(float first, float second) {
  const auto rounded = [](float x) { return std::bit_cast<std::uint32_t>(x) + kRoundToUpperHalf; };
  return std::bit_cast<float>((rounded(first) & kUpperHalf) | rounded(second) >> 16);
}
inline float unpack_bf16_first(float both) {
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(both) & kUpperHalf);
}
inline float unpack_bf16_second(float both) {
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(both) << 16);
}

/// What pack_bf16x2() loses of each number: 16 signed bits, to be added to the bits of its float.
inline float pack_bf16x2_rest(float first, float second) {
  const auto rest = [](float x) {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    return bits - ((bits + kRoundToUpperHalf) & kUpperHalf);
  };
  return std::bit_cast<float>(rest(first) << 16 | (rest(second) & ~kUpperHalf));
}

/// The two numbers in full, from pack_bf16x2() and pack_bf16x2_rest().
inline glm::vec2 unpack_bf16x2_exact(float both, float rest) {
  const auto with = [](float upper, std::uint32_t lower) {
    const auto sixteen = std::uint32_t(std::int32_t(std::int16_t(lower)));
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(upper) + sixteen);
  };
  const auto bits = std::bit_cast<std::uint32_t>(rest);
  return {with(unpack_bf16_first(both), bits >> 16),
          with(unpack_bf16_second(both), bits & ~kUpperHalf)};
}

}  // namespace ssdo
