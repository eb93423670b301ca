// SPDX-License-Identifier: Apache-2.0
//
// The first two dimensions of Sobol's sequence (1967), with Owen's nested scrambling (1995) by a
// hash in place of a tree of random bits: Laine and Karras 2011, Stratified Sampling for Stochastic
// Transparency; Burley 2020, Practical Hash-based Owen Scrambling.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>

namespace ssdo {

/// A well mixed number from three (the finaliser of MurmurHash3, Appleby 2011).
inline std::uint32_t hash_of(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const auto mix = [](std::uint32_t h) {
    h = (h ^ (h >> 16)) * 0x85ebca6bu;
    h = (h ^ (h >> 13)) * 0xc2b2ae35u;
    return h ^ (h >> 16);
  };
  return mix(a + 0x9e3779b9u * mix(b + 0x9e3779b9u * mix(c + 0x9e3779b9u)));
}

inline std::uint32_t reversed_bits(std::uint32_t x) {
  x = (x << 16) | (x >> 16);
  x = ((x & 0x00ff00ffu) << 8) | ((x >> 8) & 0x00ff00ffu);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
  x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
  return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/// Flips each bit as a hash of the lower ones says (the constants are Vegdahl's, 2021).
inline std::uint32_t scrambled_upwards(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1;
  x ^= x * 0x05526c56u;
  return x ^ (x * 0x53a22864u);
}

/// The second dimension: x^1 + 1 is its polynomial.
inline std::uint32_t sobol_second(std::uint32_t index) {
  std::uint32_t sum = 0;
  for (std::uint32_t column = 0x80000000u; index != 0; index >>= 1, column ^= column >> 1) {
    if (index & 1) sum ^= column;
  }
  return sum;
}

/// Point `index` of the sequence that `seed` scrambles, in 0..1. Any 2^k points that begin at a
/// multiple of 2^k fill every grid of 2^k equal boxes, a power of two wide and high, with one point
/// in each.
inline glm::vec2 sobol_point(std::uint32_t index, std::uint32_t seed) {
  const auto to_unit = [](std::uint32_t reversed, std::uint32_t s) {
    // 24 bits, so that rounding to float keeps them below 1.
    return (float(reversed_bits(scrambled_upwards(reversed, s)) >> 8) + 0.5f) * 0x1p-24f;
  };
  return {to_unit(index, seed), to_unit(reversed_bits(sobol_second(index)), hash_of(seed, 0, 1))};
}

}  // namespace ssdo
