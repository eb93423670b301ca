// SPDX-License-Identifier: Apache-2.0
#include "estimators/view_space/half_ball.h"

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "math/sequence_numbers.h"

namespace ssdo {

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
      const double azimuth = 2 * glm::pi<double>() * fraction(phase1 + n * kR2First);
      const double length = std::cbrt(fraction(phase2 + n * kR2Second));
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
