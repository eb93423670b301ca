// SPDX-License-Identifier: Apache-2.0
#include "estimators/trace/frame_occluders.h"

#include <algorithm>
#include <glm/geometric.hpp>

namespace ssdo {

FrameOccluders::FrameOccluders(const Scene& scene, float radius)
    : scene_(scene),
      radius_(radius),
      solids_(build_height_field(scene.casters(), scene.solids)),
      other_views_(OtherViewRays::of_added(scene.other_surfaces)) {
  for (const auto& [source, seen] : scene.blockers)
    if (!named_.contains(seen.get()))
      named_.emplace(seen.get(), build_height_field(seen->casters(), seen->solids));
}

const RayScene* FrameOccluders::named_by(std::size_t source) const {
  const auto blockers = scene_.blockers.find(source);
  return blockers == scene_.blockers.end() ? nullptr : &named_.at(blockers->second.get());
}

bool FrameOccluders::is_blocked(const TraceRay& ray, float distance) const {
  const float reach = std::min(distance, radius_);
  return solids_.is_blocked(ray.origin, ray.to, reach) ||
         (other_views_ && other_views_->is_blocked(glm::vec3(ray.origin), ray.to, reach));
}

bool FrameOccluders::is_blocked(const TraceRay& ray, float distance, std::size_t source) const {
  const RayScene* const own = named_by(source);
  if (!own) return is_blocked(ray, distance);
  return own->is_blocked(ray.origin, ray.to, std::min(distance, radius_));
}

std::optional<Met> FrameOccluders::first_met(const TraceRay& ray) const {
  const auto [hit, distance] = solids_.first_hit(ray.origin, ray.to, radius_);
  if (other_views_) {
    const auto other = other_views_->first_hit(glm::vec3(ray.origin), ray.to, radius_);
    if (other.sender >= 0 && other.distance < distance)
      return Met{true, other.unseen, std::size_t(other.sender)};
  }
  if (hit.sender < 0) return std::nullopt;
  const auto q = std::size_t(hit.sender);
  return Met{false, hit.layer == 0 && glm::dot(scene_.casters().surfel[q].normal, ray.to) > 0, q};
}

}  // namespace ssdo
