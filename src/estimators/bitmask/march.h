// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <vector>

#include "estimators/bitmask/border/border_extents.h"
#include "estimators/bitmask/border/border_light.h"
#include "estimators/bitmask/march_scene.h"
#include "estimators/bitmask/rays/depth_bounds.h"
#include "estimators/bitmask/slice_pattern.h"
#include "estimators/estimator.h"
#include "estimators/other_views/other_view_rays.h"
#include "simd/interleaved.h"

namespace ssdo {

/// What an overview sends in one pass of bounces.
struct OverviewLight {
  InterleavedVectors sent;  ///< in the order of OverviewRaster
  std::array<BorderValues, 3> border;
  float bright, level;                 ///< as Emitters has them, of the frame
  glm::vec3 mean{0};                   ///< of `sent`, as BouncedLight has it
  std::vector<LampBeyond> lamps = {};  ///< whose light `border` lacks
  std::vector<OverviewLight> lights =
      {};  ///< each light's part of it, where the bounce is by light
};

/// All of a frame as an overview shows it, for rasters that are a part of the frame.
struct OverviewScene {
  MarchScene scene;                       ///< of the overview, which is a raster like any other
  OverviewRaster raster;                  ///< the order in which slices read it
  MarchPlanes planes;                     ///< those of `scene` in that order
  std::vector<DepthBounds> bounds;        ///< by layer
  const Solids& solids;                   ///< of the overview
  CutSurfaces cut;                        ///< by the border of the overview
  Enclosure enclosure;                    ///< of the frame: see border/beyond.h
  std::vector<OverviewLight> light = {};  ///< by pass
  /// What blocks the light of lamps that name it, by their number in Light::sources. Rays alone
  /// read it: without `planes` and `light`.
  std::map<std::size_t, std::shared_ptr<const OverviewScene>> linked_occluders = {};
};

/// What all marches share.
struct March {
  const MarchScene& scene;
  const SlicePattern& pattern;
  float radius;                                ///< scene units, or infinity
  bool extend;                                 ///< surfaces go on beyond the frame
  bool may_be_thin = false;                    ///< as may_be_thin() has it of the solids
  const OtherViewRays* other_views = nullptr;  ///< what only other views show; null: nothing
  const OverviewScene* far = nullptr;  ///< where the raster is a part of a frame without its reach:
                                       ///< what marches meet beyond far->raster.from_px
  const CutSurfaces* cut = nullptr;    ///< what rays that leave the frame may meet; null: nothing
};

}  // namespace ssdo
