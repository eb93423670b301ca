// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/rays/own_blockers.h"

#include <algorithm>
#include <utility>

#include "estimators/bitmask/border/beyond.h"

namespace ssdo {

namespace {

/// What of the frame around a band blocks the light of a lamp; null: the scene is no band.
const FarScene* far_blockers_of(std::size_t source, const Request& request) {
  if (!request.around_band) return nullptr;
  return request.around_band->far->blockers.at(source).get();
}

}  // namespace

OwnBlockers::OwnBlockers(const Scene& blockers, const Scene& scene, const Request& request,
                         const SlicePattern& pattern, const FarScene* far)
    : scene_(make_march_scene(blockers.casters(), blockers.solids, request.receivers,
                              &scene.geometry)),
      bounds_(depth_bounds(scene_)),
      other_views_(OtherViewRays::of_added(blockers.other_surfaces)),
      march_{scene_,
             pattern,
             request.radius,
             request.extend_offscreen,
             may_be_thin(blockers.solids),
             other_views_.get(),
             request.around_band && request.around_band->marches_on ? far : nullptr},
      past_(far ? sun_past_beyond_of(far->openness, scene, request)
                : sun_past_beyond(scene_, scene, request)) {
  if (!march_.extend) return;
  march_.cut = &cut_;
  if (march_.far) return;
  cut_ = find_cut_surfaces(scene_, up_in_camera(scene), request.radius,
                           met_by_rays_to_sources(scene.light));
}

std::map<std::size_t, std::shared_ptr<const FarScene>> far_blockers(const Scene& scene,
                                                                    const Request& request,
                                                                    const FarRaster& raster) {
  std::map<const Scene*, std::shared_ptr<const FarScene>> built;
  std::map<std::size_t, std::shared_ptr<const FarScene>> found;
  for (const auto& [source, blockers] : scene.blockers) {
    std::shared_ptr<const FarScene>& far = built[blockers.get()];
    if (!far) {
      MarchScene seen =
          make_march_scene(blockers->casters(), blockers->solids, {}, &scene.geometry);
      std::vector<DepthBounds> bounds = depth_bounds(seen);
      CutSurfaces cut = find_cut_surfaces(seen, up_in_camera(scene), request.radius,
                                          met_by_rays_to_sources(scene.light));
      const Openness open = openness_of(seen, scene, request.radius);
      far = std::make_shared<const FarScene>(FarScene{
          std::move(seen), raster, {}, std::move(bounds), blockers->solids, std::move(cut), open});
    }
    found[source] = far;
  }
  return found;
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
  return &built_
              .try_emplace(&blockers, blockers, scene_, request_, pattern_,
                           far_blockers_of(source, request_))
              .first->second;
}

}  // namespace ssdo
