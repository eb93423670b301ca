// SPDX-License-Identifier: Apache-2.0
#include "estimators/further/further_rays.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <cstddef>
#include <glm/geometric.hpp>

#include "error.h"
#include "estimators/ray_device.h"

namespace ssdo {
namespace {

/// A ray that meets the unseen side of a surface within so many footprints of its start began on
/// the seen side of the same thin thing, which coarse triangles cut.
constexpr float kThinThing = 4;

struct Query : RTCIntersectContext {
  const std::vector<Vertex>* vertices;
  const std::vector<FurtherSurfaces::Triangle>* triangles;

  int corner(unsigned triangle, float u, float v) const {
    const float w = 1 - u - v;
    return int((*triangles)[triangle][w >= u && w >= v ? 0 : u >= v ? 1 : 2]);
  }

  static bool is_unseen(const Vertex& vertex, const float* direction) {
    return vertex.normal.x * direction[0] + vertex.normal.y * direction[1] +
               vertex.normal.z * direction[2] >
           0;
  }

  static void refuse_own_thing(const RTCFilterFunctionNArguments* hits) {
    const auto& query = *static_cast<const Query*>(hits->context);
    for (unsigned i = 0; i < hits->N; ++i) {
      if (hits->valid[i] == 0) continue;
      const int corner =
          query.corner(RTCHitN_primID(hits->hit, hits->N, i), RTCHitN_u(hits->hit, hits->N, i),
                       RTCHitN_v(hits->hit, hits->N, i));
      const Vertex& vertex = (*query.vertices)[std::size_t(corner)];
      const float direction[3] = {RTCRayN_dir_x(hits->ray, hits->N, i),
                                  RTCRayN_dir_y(hits->ray, hits->N, i),
                                  RTCRayN_dir_z(hits->ray, hits->N, i)};
      const float distance = RTCRayN_tfar(hits->ray, hits->N, i);
      if (distance < kThinThing * vertex.footprint && is_unseen(vertex, direction))
        hits->valid[i] = 0;
    }
  }
};

RTCRay ray_of(const glm::vec3& origin, const glm::vec3& direction, float reach) {
  RTCRay ray{};
  ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
  ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
  ray.tfar = reach;
  ray.mask = ~0u;
  return ray;
}

}  // namespace

struct FurtherRays::Embree {
  RTCDevice device = rtcNewDevice(kRayDevice);
  RTCScene scene = rtcNewScene(device);
  const std::vector<Vertex>& vertices;
  const std::vector<FurtherSurfaces::Triangle>& triangles;

  Embree(const std::vector<Vertex>& of, const std::vector<FurtherSurfaces::Triangle>& between)
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

  Query query() const {
    Query query;
    rtcInitIntersectContext(&query);
    query.vertices = &vertices, query.triangles = &triangles;
    query.filter = &Query::refuse_own_thing;
    return query;
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
  Query context = embree_->query();
  rtcOccluded1(embree_->scene, &context, &ray);
  return ray.tfar < 0;
}

FurtherRays::Hit FurtherRays::first_hit(const glm::vec3& origin, const glm::vec3& direction,
                                        float reach) const {
  RTCRayHit ray{ray_of(origin, direction, reach), {}};
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  Query context = embree_->query();
  rtcIntersect1(embree_->scene, &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  const Vertex& corner =
      embree_->vertices[std::size_t(context.corner(ray.hit.primID, ray.hit.u, ray.hit.v))];
  return {int(corner.sender), Query::is_unseen(corner, &direction.x), ray.ray.tfar};
}

}  // namespace ssdo
