// SPDX-License-Identifier: Apache-2.0
#include "estimators/trace/frame_occluders.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace ssdo {

RayOccluders::RayOccluders(const Scene& scene)
    : solids(build_height_field(scene.casters(), scene.solids)),
      other_views(OtherViewRays::of_added(scene.other_surfaces)) {}

bool RayOccluders::is_blocked(const TraceRay& ray, float reach) const {
  return solids.is_blocked(ray.origin, ray.to, reach) ||
         (other_views && other_views->is_blocked(glm::vec3(ray.origin), ray.to, reach));
}

FrameOccluders::FrameOccluders(const Scene& scene, float radius)
    : scene_(scene), radius_(radius), all_(scene) {
  for (const auto& [source, seen] : scene.linked_occluders) named_.try_emplace(seen.get(), *seen);
}

const RayOccluders* FrameOccluders::named_by(std::size_t source) const {
  const auto blockers = scene_.linked_occluders.find(source);
  return blockers == scene_.linked_occluders.end() ? nullptr : &named_.at(blockers->second.get());
}

bool FrameOccluders::is_blocked(const TraceRay& ray, float distance) const {
  return all_.is_blocked(ray, std::min(distance, radius_));
}

bool FrameOccluders::is_blocked(const TraceRay& ray, float distance, std::size_t source) const {
  const RayOccluders* const own = named_by(source);
  return (own ? *own : all_).is_blocked(ray, std::min(distance, radius_));
}

std::optional<SurfaceHit> FrameOccluders::first_hit(const TraceRay& ray) const {
  const auto [hit, distance] = all_.solids.first_hit(ray.origin, ray.to, radius_);
  if (all_.other_views) {
    const auto other = all_.other_views->first_hit(glm::vec3(ray.origin), ray.to, radius_);
    if (other.sender >= 0 && other.distance < distance)
      return SurfaceHit{true, other.unseen, std::size_t(other.sender)};
  }
  if (hit.sender < 0) return std::nullopt;
  const auto q = std::size_t(hit.sender);
  return SurfaceHit{false,
                    hit.layer == 0 && glm::dot(scene_.casters().surfaces[q].normal, ray.to) > 0, q};
}

}  // namespace ssdo
