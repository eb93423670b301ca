// SPDX-License-Identifier: Apache-2.0
#include "estimators/trace/ray_scene.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace ssdo {
namespace {

/// The number of the sheets among the meshes of the rays; the cuts have the next.
constexpr unsigned kSheets = 0;

const TriangleMesh& mesh_of(const HeightField& field, unsigned number) {
  return number == kSheets ? field.sheets : field.cuts;
}

TriangleRays::Mesh with_one_corner_more(TriangleMesh& mesh) {
  mesh.corners.emplace_back(0);  // so that vectors of four can be read
  return {mesh.corners.data(), mesh.corners.size() - 1, sizeof(glm::vec3), mesh.triangles};
}

}  // namespace

/// Solids whose fronts are within reach.
class RayScene::FrontsWithin final : public TriangleRays::Rule {
 public:
  FrontsWithin(const RayScene& scene, const glm::dvec3& origin, double reach)
      : scene_(scene), origin_(origin), reach_(float(reach)) {}

  bool counts(const TriangleHit& hit) const override {
    if (std::isinf(reach_)) return true;
    const TriangleMesh& mesh = mesh_of(scene_.field_, hit.mesh);
    const std::uint32_t corner = scene_.rays_.corner_of(hit);
    const glm::vec3& at = mesh.corners[corner];
    const float front = mesh.owners[corner].front;
    if (hit.mesh == kSheets && at.z == front) return true;
    return glm::distance(scene_.field_.space.position({at.x, at.y, front}), origin_) <= reach_;
  }

 private:
  const RayScene& scene_;
  glm::vec3 origin_;
  float reach_;
};

RayScene::RayScene(HeightField field)
    : field_(std::move(field)),
      rays_({with_one_corner_more(field_.sheets), with_one_corner_more(field_.cuts)},
            "method trace") {}

bool RayScene::is_blocked(const glm::dvec3& origin, const glm::dvec3& direction,
                          double reach) const {
  const FrontsWithin rule(*this, origin, reach);
  return rays_.is_blocked(field_.space.ray(origin, direction, reach),
                          std::isinf(reach) ? nullptr : &rule);
}

RayScene::Hit RayScene::first_hit(const glm::dvec3& origin, const glm::dvec3& direction,
                                  double reach) const {
  const FrontsWithin rule(*this, origin, reach);
  const TriangleRays::Ray ray = field_.space.ray(origin, direction, reach);
  const auto hit = rays_.first_hit(ray, &rule);
  if (!hit) return {};
  const glm::vec3 at = ray.origin + float(hit->distance) * ray.direction;
  return {mesh_of(field_, hit->mesh).owners[rays_.corner_of(*hit)],
          glm::distance(glm::dvec3(field_.space.position(at)), origin)};
}

}  // namespace ssdo
