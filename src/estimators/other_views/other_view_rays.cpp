// SPDX-License-Identifier: Apache-2.0
#include "estimators/other_views/other_view_rays.h"

#include <cstddef>
#include <glm/geometric.hpp>

namespace ssdo {
namespace {

/// Distance from the start of a ray, in footprints, within which hits on an unseen side are
/// ignored: the ray began on the seen side of the same thin object, which coarse triangles cut.
constexpr float kThinThing = 4;

bool is_unseen(const Vertex& vertex, const glm::vec3& direction) {
  return glm::dot(vertex.normal, direction) > 0;
}

}  // namespace

/// Accepts hits that are not on the object that a ray starts from.
class OtherViewRays::OtherThings final : public TriangleRays::Rule {
 public:
  OtherThings(const OtherViewRays& rays, const glm::vec3& direction)
      : rays_(rays), direction_(direction) {}

  bool counts(const TriangleHit& hit) const override {
    const Vertex& nearest = rays_.vertices_[rays_.rays_.corner_of(hit)];
    return hit.distance >= double(kThinThing * nearest.footprint) ||
           !is_unseen(nearest, direction_);
  }

 private:
  const OtherViewRays& rays_;
  const glm::vec3& direction_;
};

// A vertex holds more than its position, so that four floats can be read from the last one.
OtherViewRays::OtherViewRays(const std::vector<Vertex>& vertices,
                             const std::vector<OtherSurfaces::Triangle>& triangles)
    : vertices_(vertices),
      rays_({{vertices.empty() ? nullptr : &vertices.front().position, vertices.size(),
              sizeof(Vertex), triangles}},
            "other views") {}

std::unique_ptr<OtherViewRays> OtherViewRays::of_added(const OtherSurfaces& surfaces) {
  return surfaces.empty() ? nullptr
                          : std::make_unique<OtherViewRays>(surfaces.vertices, surfaces.added);
}

bool OtherViewRays::is_blocked(const glm::vec3& origin, const glm::vec3& direction,
                               float reach) const {
  const OtherThings rule(*this, direction);
  return rays_.is_blocked({origin, direction, reach}, &rule);
}

OtherViewRays::Hit OtherViewRays::first_hit(const glm::vec3& origin, const glm::vec3& direction,
                                            float reach) const {
  const OtherThings rule(*this, direction);
  const auto hit = rays_.first_hit({origin, direction, reach}, &rule);
  if (!hit) return {};
  const Vertex& vertex = vertices_[rays_.corner_of(*hit)];
  return {int(vertex.sender), is_unseen(vertex, direction), float(hit->distance)};
}

}  // namespace ssdo
