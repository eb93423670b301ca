// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace ssdo {

/// The sectors of one side of a slice: 32 pieces of equal width in the cosine of the angle theta
/// from the view direction, from 1 to -1, which is in solid angle. Bit i of a mask stands for
/// sector i.
struct SliceSectors {
  static constexpr int kCount = 32;
  static constexpr float kPerCosine = kCount / 2.0f;

  static constexpr int kDegree = 5;  ///< of the highest moment
  static constexpr int kMoments = 2 * kDegree + 1;

  /// Moment k: the integral of cos(k theta) over the cosine, in units of a sector; moment
  /// kDegree + k, k from 1: that of sin(k theta).
  static constexpr int sine_moment(int k) { return kDegree + k; }

  /// Moments over the set n of the four sectors from 4 g on, by its bits, at [moment][16 g + n].
  alignas(64) std::array<std::array<float, 128>, kMoments> of_group;

  /// Moments over the first n sectors, at [moment][n], n up to 31.
  alignas(64) std::array<std::array<float, kCount>, kMoments> of_first;
};

const SliceSectors& slice_sectors();

}  // namespace ssdo
