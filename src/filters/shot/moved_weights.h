// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "filters/shot/moved.h"
#include "filters/shot/shot_reprojection.h"
#include "math/plane.h"
#include "scene/light/light.h"

namespace ssdo {

/// The weights of another frame's values at the pixels of `now`, if pieces have moved between both
/// frames; see moved_weights.cpp.
class MovedWeights {
 public:
  static constexpr int kSquare = 4;  ///< pixels across a square of one weight, before smoothing

  /// `pieces` and `light` are in the camera space of `now`.
  MovedWeights(const KeptSurfaces& now, const std::vector<MovedPiece>& pieces, const Light& light);

  /// 0..1 for the light of a source by its number, or for all other light, below 0.
  void row(int source, const RowOfPixels& row, float* weights) const;

  /// Finds the weights of points of `now` that move. `pieces` are those that stand in it, and the
  /// other frame is `frames` later, or before.
  void weigh_moving(const KeptSurfaces& now, const std::vector<MovedPiece>& pieces,
                    const ObjectMotion& motion, int frames);

  /// After weigh_moving(): 0..1 for all light that is not of a source, where points are followed.
  void row_of_moving(const RowOfPixels& row, float* weights) const;

 private:
  static void row_of(const Plane<float>& plane, const RowOfPixels& row, float* weights);

  Plane<float> of_all_, of_moving_;
  std::vector<Plane<float>> of_sources_;
};

}  // namespace ssdo
