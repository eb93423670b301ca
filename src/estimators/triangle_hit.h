// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <tuple>

struct RTCRay;
struct RTCHit;

namespace ssdo {

/// Where a ray meets a triangle.
struct TriangleHit {
  unsigned mesh, triangle;  ///< Embree's numbers
  int corner;               ///< 0, 1 or 2: the one that counts most there
  double distance;          ///< in lengths of the ray's direction, not negative

  /// Orders by distance; equally distant triangles by their number.
  bool is_before(const TriangleHit& other) const {
    return std::tie(distance, mesh, triangle) <
           std::tie(other.distance, other.mesh, other.triangle);
  }
};

/// Recomputes a hit that Embree has found from the ray and the triangle alone, so that it does not
/// depend on the acceleration structure. Source: Moeller, Trumbore 1997.
TriangleHit hit_of(const RTCRay& ray, const RTCHit& hit, const std::array<glm::vec3, 3>& corners);

}  // namespace ssdo
