// SPDX-License-Identifier: Apache-2.0
#include "estimators/trace/ray_origin.h"

#include <algorithm>
#include <limits>

#include "estimators/ray_start.h"

namespace ssdo {

glm::dvec3 ray_origin(const RayScene& rays, const Surfel& surfel, const Stand& stand) {
  constexpr double kNoLimit = std::numeric_limits<double>::infinity();
  const double above = kAboveRoundings * surfel.rounding + kAboveFootprints * stand.footprint,
               // The footprint of a wide lens may be larger than the depth.
      most = above + std::min(double(stand.footprint), -0.5 * surfel.position.z);
  const glm::dvec3 to_viewer(stand.view),
      before = glm::dvec3(surfel.position) + above * glm::dvec3(stand.normal) + most * to_viewer;
  const double front = rays.first_hit(before, -to_viewer, kNoLimit).distance;
  return before - std::min(most, front - above) * to_viewer;
}

}  // namespace ssdo
