// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <optional>

#include "estimators/other_views/other_view_rays.h"
#include "estimators/trace/ray_scene.h"
#include "estimators/trace/senders.h"
#include "scene/scene.h"

namespace ssdo {

/// Where a ray begins, and where it goes: a unit direction in camera space.
struct TraceRay {
  const glm::dvec3& origin;
  const glm::vec3& to;
};

/// The occluders of a ray: the solids of a frame, and surfaces that only other views show.
struct RayOccluders {
  RayScene solids;
  std::unique_ptr<OtherViewRays> other_views;  ///< null: there are none

  explicit RayOccluders(const Scene& scene);

  bool is_blocked(const TraceRay& ray, float reach) const;
};

/// What rays of method trace meet: the solids of a frame, and what other views add. May be asked
/// from many threads at once.
class FrameOccluders {
 public:
  /// `radius`: the farthest at which things occlude. Errors: those of RayScene.
  FrameOccluders(const Scene& scene, float radius);

  const RayScene& solids() const { return all_.solids; }

  /// The occluders that lamp `source` names for its light; null: everything blocks it. Lamps that
  /// name the same things share them.
  const RayOccluders* named_by(std::size_t source) const;

  bool has_other_views() const { return all_.other_views != nullptr; }

  /// Whether an occluder lies on the ray before `distance`.
  bool is_blocked(const TraceRay& ray, float distance) const;

  /// The same for the light of a source, by its number: a lamp may name its occluders.
  bool is_blocked(const TraceRay& ray, float distance, std::size_t source) const;

  /// The surface that a ray meets first.
  std::optional<SurfaceHit> first_hit(const TraceRay& ray) const;

 private:
  const Scene& scene_;
  float radius_;
  RayOccluders all_;
  std::map<const Scene*, RayOccluders> named_;  ///< those of Scene::linked_occluders
};

}  // namespace ssdo
