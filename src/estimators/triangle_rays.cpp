// SPDX-License-Identifier: Apache-2.0
#include "estimators/triangle_rays.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "error.h"
#include "estimators/embree.h"
#include "math/infinity.h"

namespace ssdo {
namespace {

/// Has Embree use its kernels for AVX2 on every processor with it: rays hit at distances with other
/// last bits by those for AVX-512, which $SSDO_ISA does not turn off.
constexpr char kDevice[] = "max_isa=avx2";

/// Embree divides by an estimate of a reciprocal that each maker's processors make in another way.
/// So the reach of its rays, and the distance of a hit, are multiplied by this factor; among the
/// triangles that a ray then meets, a filter takes the first one by hit_of().
constexpr float kReachForEmbree = 1 + 1e-5f;

/// From this many triangles on memory counts more than the tenth of speed that it costs: a frame
/// of 1920 x 1080 has half as many.
constexpr std::size_t kLarge = 8'000'000;

/// Whether Embree can trace a ray: larger numbers make it end the process. Only positions far
/// outside their pixels lead to these.
bool is_traceable(const glm::vec3& v) {
  return std::abs(v.x) < kInfiniteLength && std::abs(v.y) < kInfiniteLength &&
         std::abs(v.z) < kInfiniteLength;
}

RTCRay ray_of(const TriangleRays::Ray& from) {
  RTCRay ray{};
  ray.org_x = from.origin.x, ray.org_y = from.origin.y, ray.org_z = from.origin.z;
  ray.dir_x = from.direction.x, ray.dir_y = from.direction.y, ray.dir_z = from.direction.z;
  ray.tfar = from.reach * kReachForEmbree;
  ray.mask = ~0u;
  return ray;
}

}  // namespace

/// A ray that accepts hits within its reach that its rule counts.
class TriangleRays::Query : public RayContext {
 public:
  Query(const std::vector<Mesh>& meshes, float reach, const Rule* rule)
      : meshes_(meshes), reach_(reach), rule_(rule) {
    init_context(*this);
  }

  /// The first hit, once the ray was traced.
  const std::optional<TriangleHit>& first() const { return first_; }

  /// The filter of the query: Embree asks about one hit at a time.
  static void look(const RTCFilterFunctionNArguments* hits) {
    auto& query = *static_cast<Query*>(hits->context);
    const RTCHit hit = rtcGetHitFromHitN(hits->hit, 1, 0);
    const Mesh& mesh = query.meshes_[hit.geomID];
    const auto& [a, b, c] = mesh.triangles[hit.primID];
    const TriangleHit found = hit_of(rtcGetRayFromRayN(hits->ray, 1, 0), hit,
                                     {mesh.corner(a), mesh.corner(b), mesh.corner(c)});
    if (found.distance > query.reach_ || (query.rule_ && !query.rule_->counts(found))) {
      hits->valid[0] = 0;
      return;
    }
    if (!query.first_ || found.is_before(*query.first_)) query.first_ = found;
    RTCRayN_tfar(hits->ray, 1, 0) = float(query.first_->distance) * kReachForEmbree;
  }

 private:
  const std::vector<Mesh>& meshes_;
  float reach_;
  const Rule* rule_;
  std::optional<TriangleHit> first_;
};

struct TriangleRays::Embree {
  RTCDevice device = rtcNewDevice(kDevice);
  RTCScene scene = rtcNewScene(device);

  Embree() = default;
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }

  void attach(const Mesh& mesh, unsigned id) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.corners,
                               0, mesh.stride, mesh.count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               mesh.triangles.data(), 0, 3 * sizeof(std::uint32_t),
                               mesh.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, id);
    rtcReleaseGeometry(geometry);
  }
};

const glm::vec3& TriangleRays::Mesh::corner(std::uint32_t number) const {
  const auto* bytes = reinterpret_cast<const std::byte*>(corners);
  return *reinterpret_cast<const glm::vec3*>(bytes + number * stride);
}

TriangleRays::TriangleRays(std::vector<Mesh> meshes, std::string_view what)
    : meshes_(std::move(meshes)), embree_(std::make_unique<Embree>()) {
  std::size_t triangles = 0;
  for (const Mesh& mesh : meshes_) triangles += mesh.triangles.size();
  const int flags =
      RTC_SCENE_FLAG_ROBUST | kFilterOfQuery | (triangles < kLarge ? 0 : RTC_SCENE_FLAG_COMPACT);
  rtcSetSceneFlags(embree_->scene, RTCSceneFlags(flags));
  for (std::size_t i = 0; i < meshes_.size(); ++i)
    if (!meshes_[i].triangles.empty()) embree_->attach(meshes_[i], unsigned(i));
  rtcCommitScene(embree_->scene);
  if (const RTCError error = rtcGetDeviceError(embree_->device); error != RTC_ERROR_NONE) {
    throw Error(
        ExitCode::failed,
        fmt::format("{}: Embree failed with error {} over {} triangles{}", what, int(error),
                    triangles, error == RTC_ERROR_OUT_OF_MEMORY ? " (not enough memory)" : ""));
  }
}

TriangleRays::~TriangleRays() = default;

bool TriangleRays::is_blocked(const Ray& ray, const Rule* rule) const {
  if (!is_traceable(ray.origin) || !is_traceable(ray.direction)) return false;
  RTCRay traced = ray_of(ray);
  Query query(meshes_, ray.reach, rule);
  // Without a rule, whatever is met blocks.
  trace_any(embree_->scene, query, rule ? &Query::look : nullptr, traced);
  return traced.tfar < 0;
}

std::optional<TriangleHit> TriangleRays::first_hit(const Ray& ray, const Rule* rule) const {
  if (!is_traceable(ray.origin) || !is_traceable(ray.direction)) return std::nullopt;
  RTCRayHit traced{ray_of(ray), {}};
  traced.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  Query query(meshes_, ray.reach, rule);
  trace_first(embree_->scene, query, &Query::look, traced);
  return query.first();
}

std::uint32_t TriangleRays::corner_of(const TriangleHit& hit) const {
  return meshes_[hit.mesh].triangles[hit.triangle][std::size_t(hit.corner)];
}

}  // namespace ssdo
