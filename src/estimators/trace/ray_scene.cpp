// SPDX-License-Identifier: Apache-2.0
#include "estimators/trace/ray_scene.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "error.h"
#include "estimators/ray_device.h"

namespace ssdo {
namespace {

/// From this many triangles on memory counts more than the tenth of speed that it costs: a frame
/// of 1920 x 1080 has half as many.
constexpr std::size_t kLarge = 8'000'000;

constexpr unsigned kSheets = 0, kCuts = 1;

RTCRay ray_of(const PictureSpace::Ray& from) {
  const glm::vec3 &origin = from.origin, &direction = from.direction;
  RTCRay ray{};
  ray.org_x = origin.x, ray.org_y = origin.y, ray.org_z = origin.z;
  ray.dir_x = direction.x, ray.dir_y = direction.y, ray.dir_z = direction.z;
  ray.tfar = from.reach;
  ray.mask = ~0u;
  return ray;
}

/// Whether Embree takes the ray: it ends the process over larger numbers, which only positions far
/// outside their pixels lead to.
bool is_traceable(const RTCRay& ray) {
  constexpr float kLargest = 1e18f;
  return std::abs(ray.org_x) < kLargest && std::abs(ray.org_y) < kLargest &&
         std::abs(ray.org_z) < kLargest && std::abs(ray.dir_x) < kLargest &&
         std::abs(ray.dir_y) < kLargest && std::abs(ray.dir_z) < kLargest;
}

/// A ray that asks for fronts within reach.
struct Query : RTCIntersectContext {
  const HeightField* field;
  glm::vec3 origin;
  float reach;

  Query(const HeightField& of, const glm::dvec3& from, double limit)
      : field(&of), origin(from), reach(float(limit)) {
    rtcInitIntersectContext(this);
    if (!std::isinf(limit)) filter = &Query::refuse_far_fronts;
  }

  const TriangleMesh& mesh(unsigned id) const {
    return id == kSheets ? field->sheets : field->cuts;
  }

  /// The corner of a triangle that is nearest to a place in it.
  std::uint32_t corner(unsigned id, unsigned triangle, float u, float v) const {
    const float w = 1 - u - v;
    return mesh(id).triangles[triangle][w >= u && w >= v ? 0 : u >= v ? 1 : 2];
  }

  static void refuse_far_fronts(const RTCFilterFunctionNArguments* hits) {
    const auto& query = *static_cast<const Query*>(hits->context);
    for (unsigned i = 0; i < hits->N; ++i) {
      if (hits->valid[i] == 0) continue;
      const unsigned id = RTCHitN_geomID(hits->hit, hits->N, i);
      const std::uint32_t c =
          query.corner(id, RTCHitN_primID(hits->hit, hits->N, i), RTCHitN_u(hits->hit, hits->N, i),
                       RTCHitN_v(hits->hit, hits->N, i));
      const glm::vec3& at = query.mesh(id).corners[c];
      const float front = query.mesh(id).owners[c].front;
      if (id == kSheets && at.z == front) continue;
      const glm::vec3 position = query.field->space.position({at.x, at.y, front});
      if (glm::distance(position, query.origin) > query.reach) hits->valid[i] = 0;
    }
  }
};

}  // namespace

struct RayScene::Embree {
  RTCDevice device = rtcNewDevice(kRayDevice);
  RTCScene scene = rtcNewScene(device);

  Embree() = default;
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }

  /// The mesh must outlive the scene; one corner more is read than there are.
  void attach(const TriangleMesh& mesh, unsigned id) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               mesh.corners.data(), 0, sizeof(glm::vec3), mesh.corners.size() - 1);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               mesh.triangles.data(), 0, 3 * sizeof(std::uint32_t),
                               mesh.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);
  }
};

RayScene::RayScene(HeightField field)
    : field_(std::move(field)), embree_(std::make_unique<Embree>()) {
  const std::size_t triangles = field_.sheets.triangles.size() + field_.cuts.triangles.size();
  const int flags = RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION |
                    (triangles < kLarge ? 0 : RTC_SCENE_FLAG_COMPACT);
  rtcSetSceneFlags(embree_->scene, RTCSceneFlags(flags));
  for (TriangleMesh* mesh : {&field_.sheets, &field_.cuts}) {
    if (mesh->triangles.empty()) continue;
    mesh->corners.emplace_back(0);  // so that vectors of four can be read
    embree_->attach(*mesh, mesh == &field_.sheets ? kSheets : kCuts);
  }
  rtcCommitScene(embree_->scene);
  if (const RTCError error = rtcGetDeviceError(embree_->device); error != RTC_ERROR_NONE) {
    throw Error(ExitCode::failed,
                error == RTC_ERROR_OUT_OF_MEMORY
                    ? fmt::format("method trace: not enough memory for {} triangles", triangles)
                    : fmt::format("method trace: Embree failed with error {}", int(error)));
  }
}

RayScene::~RayScene() = default;

bool RayScene::is_blocked(const glm::dvec3& origin, const glm::dvec3& direction,
                          double reach) const {
  RTCRay ray = ray_of(field_.space.ray(origin, direction, reach));
  if (!is_traceable(ray)) return false;
  Query context(field_, origin, reach);
  rtcOccluded1(embree_->scene, &context, &ray);
  return ray.tfar < 0;
}

RayScene::Hit RayScene::first_hit(const glm::dvec3& origin, const glm::dvec3& direction,
                                  double reach) const {
  const PictureSpace::Ray ray = field_.space.ray(origin, direction, reach);
  RTCRayHit query{ray_of(ray), {}};
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  if (!is_traceable(query.ray)) return {};
  Query context(field_, origin, reach);
  rtcIntersect1(embree_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  const RTCHit& hit = query.hit;
  const glm::vec3 at = ray.origin + query.ray.tfar * ray.direction;
  return {context.mesh(hit.geomID).owners[context.corner(hit.geomID, hit.primID, hit.u, hit.v)],
          glm::distance(glm::dvec3(field_.space.position(at)), origin)};
}

}  // namespace ssdo
