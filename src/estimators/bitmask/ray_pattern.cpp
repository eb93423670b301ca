// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/ray_pattern.h"

#include <cstdint>

#include "estimators/bitmask/slice_pattern.h"
#include "math/sobol.h"

namespace ssdo {

namespace {

constexpr int kMembers = Interleaving::kPeriod * Interleaving::kPeriod;

/// A rank with its bits in reverse order.
int reversed(int rank) {
  int bits = 0;
  for (int most = kMembers; most > 1; most /= 2, rank /= 2) bits = 2 * bits + rank % 2;
  return bits;
}

}  // namespace

// Points of Sobol's sequence: of neighbours in the pattern, as of consecutive seeds, any power of
// two are spread evenly in both coordinates.
PerMember<glm::vec3> directions_to(const Sun& sun, unsigned seed) {
  PerMember<glm::vec3> directions;
  for (std::size_t m = 0; m < directions.size(); ++m) {
    const auto number = std::uint32_t(reversed(SlicePattern::rank(int(m)))) ^ seed;
    directions[m] = sun.point(sobol_point(number, 0));
  }
  return directions;
}

}  // namespace ssdo
