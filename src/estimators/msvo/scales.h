// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "estimators/view_space/view_planes.h"

namespace ssdo {

/// A picture at one scale: depths and what is known of their obscurance.
///
/// A pixel of scale k stands for 2^k x 2^k pixels of the display window and has the depth of the
/// upper left one of them; where the data window lacks that pixel, that of the nearest one it has.
/// Planes repeat their first and last column for at least a vector on both sides.
struct DepthScale {
  static constexpr int kRepeats = 16;  ///< columns on the left; on the right at least twice that

  int width, height;
  int left, top;      ///< odd where the first column (row) is odd in the display window
  PaddedPlane depth;  ///< along the view axis, positive; +infinity on background
  PaddedPlane open;   ///< 1 - obscurance, 0..1

  DepthScale(int width, int height, int left, int top);

  /// A row of one of the planes; beyond the plane, the outermost row.
  const float* row(const PaddedPlane& plane, int y) const {
    return plane.row(std::clamp(y, 0, height - 1));
  }
  /// Repeats the outermost columns of a row.
  void repeat_ends(PaddedPlane& plane, int y) const;

  /// Room for vectors that reach beyond the picture.
  static PaddedLayout layout(int width, int height) { return {width + 2 * kRepeats, height}; }
};

/// Scales 0 (all pixels) to `coarsest` of a frame; `open` is not set.
std::vector<DepthScale> make_depth_scales(const ViewPlanes& planes, int coarsest);

/// How obscurance is carried from a scale to the next finer one.
struct Upsampling {
  float inverse_far;      ///< of the unit of depths below, in 1 / scene units
  float step;             ///< a pixel's width for the blur, in the unit of far / depth
  float blur_tolerance;   ///< squared cosine of the sharpest bend that is blurred across
  float depth_tolerance;  ///< depths that differ by less weigh the same
  float noise;            ///< weight of "open" beside those of the four coarse pixels
};

/// Blurs `coarse.open` along surfaces and multiplies `fine.open` by it, or, where `fine` has
/// nothing of its own, sets it.
void upsample(const DepthScale& coarse, const Upsampling& how, bool multiply, DepthScale& fine);

}  // namespace ssdo
