// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "estimators/march_scene.h"
#include "estimators/slice_pattern.h"
#include "parallel/interleaved.h"

namespace ssdo {

using InterleavedColor = std::array<InterleavedPlane, 3>;

/// What all marches share.
struct March {
  const MarchScene& scene;
  const SlicePattern& pattern;
  float radius;  ///< scene units, or infinity
  bool extend;   ///< surfaces go on beyond the frame
};

/// How open each pixel is, and to which light.
struct VisibilityJob {
  March march;
  /// Bands of spherical harmonics that light is gathered in, up to 4; 0: no direction matters.
  int order;
  /// Weights of the basis polynomials, (order + 1)^2 for red, then green, then blue.
  const float* light;

  InterleavedPlane* ao;
  InterleavedColor* bent;              ///< not normalised; null: not wanted
  InterleavedColor* share;             ///< of the unoccluded light, 0..1; null: not wanted
  InterleavedColor* share_difference;  ///< standard error of share, signed; null: not wanted
};

/// What each pixel receives from the first surface in every direction: the mean radiance of what
/// hides the environment, times how much of it is hidden.
struct BounceJob {
  March march;
  const InterleavedPlane* ao;
  const InterleavedColor* sent;         ///< radiance of what is seen
  const InterleavedColor* sent_back;    ///< of its other side; null: the same
  const InterleavedColor* sent_behind;  ///< of what is covered
  const BorderValues* sent_border;      ///< of what goes on beyond the frame, three
  InterleavedColor* bounce;
  InterleavedColor* difference;  ///< its standard error, signed; null: not wanted
};

/// Whether each pixel sees a sun.
struct SunJob {
  struct Direction {
    float x, y, z;
  };
  March march;
  /// For each member of the pattern a unit direction to a point of the sun, and where on the way
  /// there the march looks, near to far.
  std::array<Direction, Interleaving::kPeriod * Interleaving::kPeriod> directions;
  std::array<std::vector<float>, Interleaving::kPeriod * Interleaving::kPeriod> distances_px;
  InterleavedPlane* visible;  ///< 0 or 1
};

/// All work on rows y0 to y1 of the picture.
void march_visibility(const VisibilityJob& job, int y0, int y1);
void march_bounce(const BounceJob& job, int y0, int y1);
void march_sun(const SunJob& job, int y0, int y1);

}  // namespace ssdo
