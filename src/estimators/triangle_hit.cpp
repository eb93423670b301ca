// SPDX-License-Identifier: Apache-2.0
#include "estimators/triangle_hit.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "estimators/embree.h"

namespace ssdo {

TriangleHit hit_of(const RTCRay& ray, const RTCHit& hit, const std::array<glm::vec3, 3>& corners) {
  const glm::dvec3 to(ray.dir_x, ray.dir_y, ray.dir_z), origin(ray.org_x, ray.org_y, ray.org_z),
      a(corners[0]), from_a = origin - a, first = glm::dvec3(corners[1]) - a,
                     second = glm::dvec3(corners[2]) - a, normal = glm::cross(first, second),
                     across = glm::cross(from_a, to);
  const double facing = -glm::dot(to, normal), u = glm::dot(second, across) / facing,
               v = -glm::dot(first, across) / facing, w = 1 - u - v,
               distance = glm::dot(from_a, normal) / facing;
  // A triangle that is seen edge-on has no plane to meet: it is met between its corners.
  const auto along = [&, length = glm::dot(to, to)](const glm::vec3& corner) {
    return std::max(0.0, glm::dot(glm::dvec3(corner) - origin, to) / length);
  };
  const auto [nearest, farthest] =
      std::minmax({along(corners[0]), along(corners[1]), along(corners[2])});
  const int corner = w >= u && w >= v ? 0 : u >= v ? 1 : 2;
  return {hit.geomID, hit.primID, corner,
          distance >= nearest ? std::min(distance, farthest) : nearest};
}

}  // namespace ssdo
