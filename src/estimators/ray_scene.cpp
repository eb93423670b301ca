// SPDX-License-Identifier: Apache-2.0
#include "estimators/ray_scene.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <utility>

#include "error.h"

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

}  // namespace

struct RayScene::Embree {
  RTCDevice device = rtcNewDevice(nullptr);
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
  rtcSetSceneFlags(embree_->scene, triangles < kLarge
                                       ? RTC_SCENE_FLAG_ROBUST
                                       : RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_COMPACT);
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
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(embree_->scene, &context, &ray);
  return ray.tfar < 0;
}

Owner RayScene::first_hit(const glm::dvec3& origin, const glm::dvec3& direction,
                          double reach) const {
  RTCRayHit query{ray_of(field_.space.ray(origin, direction, reach)), {}};
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(embree_->scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  const TriangleMesh& mesh = query.hit.geomID == kSheets ? field_.sheets : field_.cuts;
  const float u = query.hit.u, v = query.hit.v, w = 1 - u - v;
  const int nearest = w >= u && w >= v ? 0 : u >= v ? 1 : 2;
  return mesh.owners[mesh.triangles[query.hit.primID][std::size_t(nearest)]];
}

}  // namespace ssdo
