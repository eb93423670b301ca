// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <vector>

namespace ssdo {

/// The points of one pixel of the pattern, in the unit half-ball about +z.
struct HalfBallSample {
  glm::vec3 direction;  ///< unit; its z is the cosine
  float length;         ///< distance from the centre, 0..1
};

/// `size` x `size` sets of `count` points, row by row, each uniform in the volume of the half-ball.
///
/// Every set has one cosine in each of `count` equal strata: uniform solid angle is uniform in the
/// cosine. From set to set they move through their strata, neighbours in opposite directions, so
/// that the mean cosine of each set stays exactly 1/2 and an open surface reads 1 whatever `count`
/// is. Azimuth and volume follow the additive recurrence R2 of Roberts
/// (2018), one sequence through all sets.
std::vector<std::vector<HalfBallSample>> half_ball_pattern(int size, int count, unsigned seed);

}  // namespace ssdo
