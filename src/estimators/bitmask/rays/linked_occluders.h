// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <vector>

#include "estimators/bitmask/jobs.h"
#include "scene/scene.h"

namespace ssdo {

/// The blockers of lamps that name their own (Scene::linked_occluders), as rays read them.
class LinkedOccluders {
 public:
  /// `far`: what goes on in an overview beyond the raster; null: nothing.
  LinkedOccluders(const Scene& blockers, const Scene& scene, const Request& request,
                  const SlicePattern& pattern, const OverviewScene* far);
  LinkedOccluders(const LinkedOccluders&) = delete;  // a march refers to the others
  LinkedOccluders& operator=(const LinkedOccluders&) = delete;

  /// To be finished by find_source().
  SourceJob job(const std::vector<PointsOfSource>& points, const Source& source) const;

 private:
  const MarchScene scene_;
  const std::vector<DepthBounds> bounds_;
  CutSurfaces cut_;
  const std::unique_ptr<OtherViewRays> other_views_;  ///< null: there are no other views
  March march_;
  float past_;  ///< as offscreen_sun_visibility() has it
};

/// What blocks the light of lamps in the overview of a frame, whose scene is `scene`: for
/// OverviewScene::linked_occluders.
std::map<std::size_t, std::shared_ptr<const OverviewScene>> overview_blockers(
    const Scene& scene, const Request& request, const OverviewRaster& raster);

/// The LinkedOccluders of all sources of a scene. Lamps that name the same blockers share them.
class LinkedOccludersOfSources {
 public:
  LinkedOccludersOfSources(const Scene& scene, const Request& request, const SlicePattern& pattern)
      : scene_(scene), request_(request), pattern_(pattern) {}

  /// Null: all that casts blocks the light of this source. Sources are asked for in ascending
  /// order: what no source from this one on names is freed.
  const LinkedOccluders* of(std::size_t source);

 private:
  const Scene& scene_;
  const Request& request_;
  const SlicePattern& pattern_;
  std::map<const Scene*, LinkedOccluders> built_;
};

}  // namespace ssdo
