// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "estimators/bitmask/jobs.h"
#include "scene/scene.h"

namespace ssdo {

/// What blocks the light of a lamp that names it (Scene::blockers), as rays read it.
class OwnBlockers {
 public:
  /// Null: all that casts blocks the light of this source.
  static std::unique_ptr<const OwnBlockers> of(const Scene& scene, std::size_t source,
                                               const Request& request, const SlicePattern& pattern);

  /// To be finished by find_source().
  SourceJob job(const std::vector<PointsOfSource>& points, const Source& source) const;

 private:
  OwnBlockers(const Scene& blockers, const Scene& scene, const Request& request,
              const SlicePattern& pattern);

  const MarchScene scene_;
  const std::vector<DepthBounds> bounds_;
  CutSurfaces cut_;
  March march_;
  float past_;  ///< as sun_past_beyond() has it
};

}  // namespace ssdo
