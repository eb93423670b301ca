// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace ssdo {

/// A ratio of light in 16 bits, in steps of 1/8192. Values from -4 to 4 are kept: noise leaves the
/// range 0..1, and clamping to that range would bias means.
class FixedRatio16 {
 public:
  static constexpr float kSteps = 8192;           ///< of 1
  static constexpr float kMost = 32767 / kSteps;  ///< the largest

  FixedRatio16() = default;
  /// The nearest; not-a-number is not allowed.
  FixedRatio16(float share)
      : steps_(std::int16_t(std::lrint(kSteps * std::clamp(share, -kMost, kMost)))) {}
  operator float() const { return float(steps_) / kSteps; }

 private:
  std::int16_t steps_ = 0;
};

}  // namespace ssdo
