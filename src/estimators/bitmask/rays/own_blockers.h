// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <vector>

#include "estimators/bitmask/jobs.h"
#include "scene/scene.h"

namespace ssdo {

/// The blockers of lamps that name their own (Scene::blockers), as rays read them.
class OwnBlockers {
 public:
  /// `far`: what goes on in an overview beyond the raster; null: nothing.
  OwnBlockers(const Scene& blockers, const Scene& scene, const Request& request,
              const SlicePattern& pattern, const FarScene* far);
  OwnBlockers(const OwnBlockers&) = delete;  // a march refers to the others
  OwnBlockers& operator=(const OwnBlockers&) = delete;

  /// To be finished by find_source().
  SourceJob job(const std::vector<PointsOfSource>& points, const Source& source) const;

 private:
  const MarchScene scene_;
  const std::vector<DepthBounds> bounds_;
  CutSurfaces cut_;
  const std::unique_ptr<OtherViewRays> other_views_;  ///< null: there are no other views
  March march_;
  float past_;  ///< as sun_past_beyond() has it
};

/// What blocks the light of lamps in the overview of a frame, whose scene is `scene`: for
/// FarScene::blockers.
std::map<std::size_t, std::shared_ptr<const FarScene>> far_blockers(const Scene& scene,
                                                                    const Request& request,
                                                                    const FarRaster& raster);

/// The OwnBlockers of all sources of a scene. Lamps that name the same blockers share them.
class BlockersOfSources {
 public:
  BlockersOfSources(const Scene& scene, const Request& request, const SlicePattern& pattern)
      : scene_(scene), request_(request), pattern_(pattern) {}

  /// Null: all that casts blocks the light of this source. Sources are asked for in ascending
  /// order: what no source from this one on names is freed.
  const OwnBlockers* of(std::size_t source);

 private:
  const Scene& scene_;
  const Request& request_;
  const SlicePattern& pattern_;
  std::map<const Scene*, OwnBlockers> built_;
};

}  // namespace ssdo
