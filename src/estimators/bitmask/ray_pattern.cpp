// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/ray_pattern.h"

#include <cmath>

#include "estimators/bitmask/slice_pattern.h"
#include "math/sequence_numbers.h"

namespace ssdo {

PerMember<glm::vec3> directions_to(const Sun& sun) {
  PerMember<glm::vec3> directions;
  for (std::size_t m = 0; m < directions.size(); ++m) {
    const int rank = SlicePattern::rank(int(m));
    const glm::vec2 u((float(rank) + 0.5f) / float(directions.size()),
                      float(fraction(rank * kR2First)));
    directions[m] = sun.point(u);
  }
  return directions;
}

}  // namespace ssdo
