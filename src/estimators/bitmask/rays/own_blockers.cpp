// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/rays/own_blockers.h"

#include <algorithm>

#include "estimators/bitmask/beyond.h"

namespace ssdo {

OwnBlockers::OwnBlockers(const Scene& blockers, const Scene& scene, const Request& request,
                         const SlicePattern& pattern)
    : scene_(make_march_scene(blockers.casters(), blockers.solids, request.receivers,
                              &scene.geometry)),
      bounds_(depth_bounds(scene_)),
      other_views_(OtherViewRays::of_added(blockers.other_surfaces)),
      march_{scene_,
             pattern,
             request.radius,
             request.extend_offscreen,
             may_be_thin(blockers.solids),
             other_views_.get()},
      past_(sun_past_beyond(scene_, scene, request)) {
  if (!march_.extend) return;
  cut_ = find_cut_surfaces(scene_, up_in_camera(scene), request.radius,
                           met_by_rays_to_sources(scene.light));
  march_.cut = &cut_;
}

SourceJob OwnBlockers::job(const std::vector<PointsOfSource>& points, const Source& source) const {
  return {march_, bounds_, points, source, pass_beyond(past_, source)};
}

const OwnBlockers* BlockersOfSources::of(std::size_t source) {
  const auto& named = scene_.blockers;
  std::erase_if(built_, [&](const auto& built) {
    return std::none_of(named.lower_bound(source), named.end(),
                        [&](const auto& by) { return by.second.get() == built.first; });
  });
  const auto found = named.find(source);
  if (found == named.end()) return nullptr;
  const Scene& blockers = *found->second;
  return &built_.try_emplace(&blockers, blockers, scene_, request_, pattern_).first->second;
}

}  // namespace ssdo
