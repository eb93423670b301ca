// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

namespace ssdo {

/// Step of the additive recurrence R1, the golden ratio's: fraction(n * kR1) fills 0..1 evenly, and
/// with n / count in 0..1 beside it the unit square.
constexpr double kR1 = 0.6180339887498949;

/// Steps of the additive recurrence R2 (Roberts 2018): 1/g and 1/g^2 for g^3 = g + 1. The points
/// fraction(n * first), fraction(n * second) fill the unit square evenly.
constexpr double kR2First = 0.7548776662466927, kR2Second = 0.5698402909980532;

inline double fraction(double x) { return x - std::floor(x); }

/// A start in 0..1 from a seed (the finaliser of SplitMix64; Steele, Lea, Flood 2014).
inline double start_of(std::uint64_t seed) {
  seed += 0x9e3779b97f4a7c15u;
  seed = (seed ^ (seed >> 30)) * 0xbf58476d1ce4e5b9u;
  seed = (seed ^ (seed >> 27)) * 0x94d049bb133111ebu;
  return double((seed ^ (seed >> 31)) >> 11) * 0x1p-53;
}

}  // namespace ssdo
