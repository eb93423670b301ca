// SPDX-License-Identifier: Apache-2.0
#include "estimators/trace/ray_scene.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <utility>

#include "error.h"
#include "estimators/ray_device.h"
#include "estimators/triangle_hit.h"

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
  ray.tfar = from.reach * kReachForEmbree;
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

/// A ray that asks for what is within reach with its front.
class Query : public RTCIntersectContext {
 public:
  Query(const HeightField& field, const glm::dvec3& origin, double reach,
        const PictureSpace::Ray& ray)
      : field_(field), origin_(origin), reach_(float(reach)), reach_in_picture_(ray.reach) {
    rtcInitIntersectContext(this);
    filter = &Query::look;
  }

  /// What the ray meets first, once it was traced, and what the corner belongs to that is nearest
  /// there; none for a ray that meets nothing.
  struct Met {
    TriangleHit hit;
    Owner owner;
  };
  const std::optional<Met>& first() const { return first_; }

 private:
  /// Embree asks about one hit at a time.
  static void look(const RTCFilterFunctionNArguments* hits) {
    auto& query = *static_cast<Query*>(hits->context);
    const RTCHit hit = rtcGetHitFromHitN(hits->hit, 1, 0);
    const TriangleMesh& mesh = hit.geomID == kSheets ? query.field_.sheets : query.field_.cuts;
    const auto& corners = mesh.triangles[hit.primID];
    const TriangleHit found =
        hit_of(rtcGetRayFromRayN(hits->ray, 1, 0), hit,
               {mesh.corners[corners[0]], mesh.corners[corners[1]], mesh.corners[corners[2]]});
    const std::uint32_t corner = corners[std::size_t(found.corner)];
    const Owner& owner = mesh.owners[corner];
    if (found.distance > query.reach_in_picture_ ||
        query.is_behind_far_front(hit.geomID, mesh.corners[corner], owner.front)) {
      hits->valid[0] = 0;
      return;
    }
    if (!query.first_ || found.is_before(query.first_->hit)) query.first_ = Met{found, owner};
    RTCRayN_tfar(hits->ray, 1, 0) = float(query.first_->hit.distance) * kReachForEmbree;
  }

  bool is_behind_far_front(unsigned geometry, const glm::vec3& at, float front) const {
    if (std::isinf(reach_) || (geometry == kSheets && at.z == front)) return false;
    return glm::distance(field_.space.position({at.x, at.y, front}), origin_) > reach_;
  }

  const HeightField& field_;
  glm::vec3 origin_;
  float reach_, reach_in_picture_;
  std::optional<Met> first_;
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
  const PictureSpace::Ray in_picture = field_.space.ray(origin, direction, reach);
  RTCRay ray = ray_of(in_picture);
  if (!is_traceable(ray)) return false;
  Query query(field_, origin, reach, in_picture);
  if (std::isinf(reach)) query.filter = nullptr;  // whatever is met blocks
  rtcOccluded1(embree_->scene, &query, &ray);
  return ray.tfar < 0;
}

RayScene::Hit RayScene::first_hit(const glm::dvec3& origin, const glm::dvec3& direction,
                                  double reach) const {
  const PictureSpace::Ray ray = field_.space.ray(origin, direction, reach);
  RTCRayHit traced{ray_of(ray), {}};
  traced.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  if (!is_traceable(traced.ray)) return {};
  Query query(field_, origin, reach, ray);
  rtcIntersect1(embree_->scene, &query, &traced);
  if (!query.first()) return {};
  const auto& [hit, owner] = *query.first();
  const glm::vec3 at = ray.origin + float(hit.distance) * ray.direction;
  return {owner, glm::distance(glm::dvec3(field_.space.position(at)), origin)};
}

}  // namespace ssdo
