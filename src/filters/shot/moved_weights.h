// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "filters/shot/moved.h"
#include "filters/shot/sights.h"
#include "math/plane.h"
#include "scene/light/light.h"

namespace ssdo {

/// How much of what another frame says counts at the pixels of `now`, where pieces have moved
/// between both; see moved_weights.cpp.
class MovedWeights {
 public:
  static constexpr int kSquare = 4;  ///< pixels across what has one weight before it is smoothed

  /// `pieces` and `light` are in the camera space of `now`.
  MovedWeights(const KeptSurfaces& now, const std::vector<MovedPiece>& pieces, const Light& light);

  /// 0..1 for the light of a source by its number, or for all other light, below 0.
  void row(int source, const RowOfPixels& row, float* weights) const;

 private:
  Plane<float> of_all_;
  std::vector<Plane<float>> of_sources_;
};

}  // namespace ssdo
