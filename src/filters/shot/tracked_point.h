// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace ssdo {

/// Where another frame shows the moving point of a pixel.
struct TrackedPoint {
  int x;               ///< of the pixel in its row
  std::int32_t pixel;  ///< of the other frame, and its weights, as in ReprojectedPoints
  float weight[4];
  float track_weight;  ///< 0..1: weight of this lookup over the one at rest
  float confidence;    ///< 0..1: how much of what the other frame says counts, of all light
                       ///< that is not of a source
};

}  // namespace ssdo
