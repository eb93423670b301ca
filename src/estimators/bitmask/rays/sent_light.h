// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/bitmask/march_scene.h"
#include "simd/interleaved.h"

namespace ssdo {

struct OverviewScene;
struct OverviewLight;

/// The light that is sent in a pass of bounces.
struct SentLight {
  const MarchScene& scene;
  const InterleavedVectors& radiance;
  bool two_sided;                      ///< as SenderJob has it
  Window lit;                          ///< the pixels whose radiance is known
  const OverviewScene* far = nullptr;  ///< the frame around; null: the raster is all that sends
  const OverviewLight* overview_light = nullptr;
};

}  // namespace ssdo
