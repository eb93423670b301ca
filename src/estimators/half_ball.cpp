// SPDX-License-Identifier: Apache-2.0
#include "estimators/half_ball.h"

#include <cmath>
#include <cstdint>
#include <glm/gtc/constants.hpp>

namespace ssdo {
namespace {

// 1/g and 1/g^2 for g^3 = g + 1: the steps of R2.
constexpr double kAlpha1 = 0.7548776662466927, kAlpha2 = 0.5698402909980532;

double fraction(double x) { return x - std::floor(x); }

/// A start in 0..1 from the seed (the finaliser of SplitMix64; Steele, Lea, Flood 2014).
double start_of(std::uint64_t seed) {
  seed += 0x9e3779b97f4a7c15u;
  seed = (seed ^ (seed >> 30)) * 0xbf58476d1ce4e5b9u;
  seed = (seed ^ (seed >> 27)) * 0x94d049bb133111ebu;
  return double((seed ^ (seed >> 31)) >> 11) * 0x1p-53;
}

}  // namespace

std::vector<std::vector<HalfBallSample>> half_ball_pattern(int size, int count, unsigned seed) {
  const int sets = size * size;
  const double phase1 = start_of(2 * std::uint64_t(seed)),
               phase2 = start_of(2 * std::uint64_t(seed) + 1);
  std::vector<std::vector<HalfBallSample>> pattern(static_cast<std::size_t>(sets));
  for (int set = 0; set < sets; ++set) {
    auto& samples = pattern[std::size_t(set)];
    const double shift = (set + 0.5) / sets - 0.5;
    for (int i = 0; i < count; ++i) {
      // One sequence runs through all sets, so that together they fill the half-ball evenly.
      const double n = double(i) * sets + set;
      const double azimuth = 2 * glm::pi<double>() * fraction(phase1 + n * kAlpha1);
      const double length = std::cbrt(fraction(phase2 + n * kAlpha2));
      const bool paired = (i | 1) < count;
      const double place = 0.5 + (paired ? (i % 2 == 0 ? shift : -shift) : 0.0);
      const double cosine = (i + place) / count, sine = std::sqrt(1 - cosine * cosine);
      samples.push_back(
          {{float(sine * std::cos(azimuth)), float(sine * std::sin(azimuth)), float(cosine)},
           float(length)});
    }
  }
  return pattern;
}

}  // namespace ssdo
