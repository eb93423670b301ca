// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/ray_pattern.h"

#include <cmath>

#include "estimators/bitmask/slice_pattern.h"
#include "math/frame.h"
#include "math/sampling.h"
#include "math/sequence_numbers.h"

namespace ssdo {
namespace {

/// The edge of a shadow that single rays throw shows their steps, because no other slices average
/// them away.
constexpr int kSteps = 2;

}  // namespace

RayDistances ray_distances(const Window& display, int steps) {
  RayDistances distances_px;
  const double diagonal = std::hypot(display.width(), display.height());
  for (std::size_t m = 0; m < distances_px.size(); ++m) {
    const double start = fraction(SlicePattern::rank(int(m)) * kR2Second);
    for (int i = 0; i < kSteps * steps; ++i)
      distances_px[m].push_back(float(march_distance((i + start) / (kSteps * steps), diagonal)));
  }
  return distances_px;
}

PerMember<glm::vec3> directions_to(const Sun& sun) {
  PerMember<glm::vec3> directions;
  const glm::mat3 frame = frame_about(sun.direction);
  for (std::size_t m = 0; m < directions.size(); ++m) {
    const int rank = SlicePattern::rank(int(m));
    const glm::vec2 u((float(rank) + 0.5f) / float(directions.size()),
                      float(fraction(rank * kR2First)));
    directions[m] = disc_direction(frame, sun.angular_radius, u);
  }
  return directions;
}

}  // namespace ssdo
