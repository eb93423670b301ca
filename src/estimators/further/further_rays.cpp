// SPDX-License-Identifier: Apache-2.0
#include "estimators/further/further_rays.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <cstddef>
#include <glm/geometric.hpp>
#include <optional>

#include "error.h"
#include "estimators/ray_device.h"
#include "estimators/triangle_hit.h"

namespace ssdo {
namespace {

/// A ray that meets the unseen side of a surface within so many footprints of its start began on
/// the seen side of the same thin thing, which coarse triangles cut.
constexpr float kThinThing = 4;

bool is_unseen(const Vertex& vertex, const glm::vec3& direction) {
  return glm::dot(vertex.normal, direction) > 0;
}

using Triangles = std::vector<FurtherSurfaces::Triangle>;

/// A ray that asks for what is within reach and not of the thing that it starts from.
class Query : public RTCIntersectContext {
 public:
  Query(const std::vector<Vertex>& vertices, const Triangles& triangles, float reach)
      : vertices_(vertices), triangles_(triangles), reach_(reach) {
    rtcInitIntersectContext(this);
    filter = &Query::look;
  }

  /// What the ray meets first, once it was traced, and the vertex that is nearest there; none for a
  /// ray that meets nothing.
  struct Met {
    TriangleHit hit;
    const Vertex& vertex;
  };
  const std::optional<Met>& first() const { return first_; }

 private:
  /// Embree asks about one hit at a time.
  static void look(const RTCFilterFunctionNArguments* hits) {
    auto& query = *static_cast<Query*>(hits->context);
    const RTCRay ray = rtcGetRayFromRayN(hits->ray, 1, 0);
    const RTCHit hit = rtcGetHitFromHitN(hits->hit, 1, 0);
    const auto& corners = query.triangles_[hit.primID];
    const auto vertex = [&](int corner) -> const Vertex& {
      return query.vertices_[corners[std::size_t(corner)]];
    };
    const TriangleHit found =
        hit_of(ray, hit, {vertex(0).position, vertex(1).position, vertex(2).position});
    const Vertex& nearest = vertex(found.corner);
    const bool is_own_thing = found.distance < double(kThinThing * nearest.footprint) &&
                              is_unseen(nearest, {ray.dir_x, ray.dir_y, ray.dir_z});
    if (found.distance > query.reach_ || is_own_thing) {
      hits->valid[0] = 0;
      return;
    }
    if (!query.first_ || found.is_before(query.first_->hit))
      query.first_.emplace(Met{found, nearest});
    RTCRayN_tfar(hits->ray, 1, 0) = float(query.first_->hit.distance) * kReachForEmbree;
  }

  const std::vector<Vertex>& vertices_;
  const Triangles& triangles_;
  float reach_;
  std::optional<Met> first_;
};

RTCRay ray_of(const glm::vec3& origin, const glm::vec3& direction, float reach) {
  RTCRay ray{};
  ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
  ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
  ray.tfar = reach * kReachForEmbree;
  ray.mask = ~0u;
  return ray;
}

}  // namespace

struct FurtherRays::Embree {
  RTCDevice device = rtcNewDevice(kRayDevice);
  RTCScene scene = rtcNewScene(device);
  const std::vector<Vertex>& vertices;
  const Triangles& triangles;

  Embree(const std::vector<Vertex>& of, const Triangles& between)
      : vertices(of), triangles(between) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    // A vertex holds more than its position, so that four floats can be read from the last one.
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, of.data(),
                               offsetof(Vertex, position), sizeof(Vertex), of.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, between.data(),
                               0, sizeof(FurtherSurfaces::Triangle), between.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(scene,
                     RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
    rtcCommitScene(scene);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

FurtherRays::FurtherRays(const std::vector<Vertex>& vertices,
                         const std::vector<FurtherSurfaces::Triangle>& triangles)
    : embree_(std::make_unique<Embree>(vertices, triangles)) {
  if (const RTCError error = rtcGetDeviceError(embree_->device); error != RTC_ERROR_NONE) {
    throw Error(ExitCode::failed,
                fmt::format("further views: Embree failed with error {} over {} triangles{}",
                            int(error), triangles.size(),
                            error == RTC_ERROR_OUT_OF_MEMORY ? " (not enough memory)" : ""));
  }
}

FurtherRays::~FurtherRays() = default;

bool FurtherRays::is_blocked(const glm::vec3& origin, const glm::vec3& direction,
                             float reach) const {
  RTCRay ray = ray_of(origin, direction, reach);
  Query query(embree_->vertices, embree_->triangles, reach);
  rtcOccluded1(embree_->scene, &query, &ray);
  return ray.tfar < 0;
}

FurtherRays::Hit FurtherRays::first_hit(const glm::vec3& origin, const glm::vec3& direction,
                                        float reach) const {
  RTCRayHit ray{ray_of(origin, direction, reach), {}};
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  Query query(embree_->vertices, embree_->triangles, reach);
  rtcIntersect1(embree_->scene, &query, &ray);
  if (!query.first()) return {};
  const auto& [hit, vertex] = *query.first();
  return {int(vertex.sender), is_unseen(vertex, direction), float(hit.distance)};
}

}  // namespace ssdo
