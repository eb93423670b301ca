// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/rays/own_blockers.h"

#include "estimators/bitmask/beyond.h"

namespace ssdo {

OwnBlockers::OwnBlockers(const Scene& blockers, const Scene& scene, const Request& request,
                         const SlicePattern& pattern)
    : scene_(make_march_scene(blockers.casters(), blockers.solids, request.receivers,
                              &scene.geometry)),
      bounds_(depth_bounds(scene_)),
      march_{scene_, pattern, request.radius, request.extend_offscreen},
      past_(sun_past_beyond(scene_, scene, request)) {
  if (!march_.extend) return;
  cut_ = find_cut_surfaces(scene_, up_in_camera(scene), request.radius);
  march_.cut = &cut_;
}

std::unique_ptr<const OwnBlockers> OwnBlockers::of(const Scene& scene, std::size_t source,
                                                   const Request& request,
                                                   const SlicePattern& pattern) {
  const auto found = scene.blockers.find(source);
  if (found == scene.blockers.end()) return nullptr;
  return std::unique_ptr<const OwnBlockers>(
      new OwnBlockers(*found->second, scene, request, pattern));
}

SourceJob OwnBlockers::job(const std::vector<PointsOfSource>& points, const Source& source) const {
  return {march_, bounds_, points, source, pass_beyond(past_, source)};
}

}  // namespace ssdo
