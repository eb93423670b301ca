// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/rays/linked_occluders.h"

#include <algorithm>
#include <utility>

#include "estimators/bitmask/border/beyond.h"

namespace ssdo {

namespace {

/// What of the frame around a band blocks the light of a lamp; null: the scene is no band.
const OverviewScene* overview_blockers_of(std::size_t source, const Request& request) {
  if (!request.around_band) return nullptr;
  return request.around_band->far->linked_occluders.at(source).get();
}

}  // namespace

LinkedOccluders::LinkedOccluders(const Scene& blockers, const Scene& scene, const Request& request,
                                 const SlicePattern& pattern, const OverviewScene* far)
    : scene_(make_march_scene(blockers.casters(), blockers.solids, request.receivers,
                              &scene.geometry, request.radius)),
      bounds_(depth_bounds(scene_)),
      other_views_(OtherViewRays::of_added(blockers.other_surfaces)),
      march_{scene_,
             pattern,
             request.radius,
             request.extend_offscreen,
             may_be_thin(blockers.solids),
             other_views_.get(),
             request.around_band && request.around_band->continues_in_overview ? far : nullptr},
      past_(far ? offscreen_sun_visibility_of(far->enclosure, scene, request)
                : offscreen_sun_visibility(scene_, scene, request)) {
  if (!march_.extend) return;
  march_.cut = &cut_;
  if (march_.far) return;
  cut_ = find_cut_surfaces(scene_, up_in_camera(scene), request.radius,
                           met_by_rays_to_sources(scene.light));
}

std::map<std::size_t, std::shared_ptr<const OverviewScene>> overview_blockers(
    const Scene& scene, const Request& request, const OverviewRaster& raster) {
  std::map<const Scene*, std::shared_ptr<const OverviewScene>> built;
  std::map<std::size_t, std::shared_ptr<const OverviewScene>> found;
  for (const auto& [source, blockers] : scene.linked_occluders) {
    std::shared_ptr<const OverviewScene>& far = built[blockers.get()];
    if (!far) {
      MarchScene seen = make_march_scene(blockers->casters(), blockers->solids, {}, &scene.geometry,
                                         request.radius);
      std::vector<DepthBounds> bounds = depth_bounds(seen);
      CutSurfaces cut = find_cut_surfaces(seen, up_in_camera(scene), request.radius,
                                          met_by_rays_to_sources(scene.light));
      const Enclosure open = enclosure_of(seen, scene, request.radius);
      far = std::make_shared<const OverviewScene>(OverviewScene{
          std::move(seen), raster, {}, std::move(bounds), blockers->solids, std::move(cut), open});
    }
    found[source] = far;
  }
  return found;
}

SourceJob LinkedOccluders::job(const std::vector<PointsOfSource>& points,
                               const Source& source) const {
  return {march_, bounds_, points, source, offscreen_visibility(past_, source)};
}

const LinkedOccluders* LinkedOccludersOfSources::of(std::size_t source) {
  const auto& named = scene_.linked_occluders;
  std::erase_if(built_, [&](const auto& built) {
    return std::none_of(named.lower_bound(source), named.end(),
                        [&](const auto& by) { return by.second.get() == built.first; });
  });
  const auto found = named.find(source);
  if (found == named.end()) return nullptr;
  const Scene& blockers = *found->second;
  return &built_
              .try_emplace(&blockers, blockers, scene_, request_, pattern_,
                           overview_blockers_of(source, request_))
              .first->second;
}

}  // namespace ssdo
