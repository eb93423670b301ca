// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace ssdo {

/// A pixel of another frame, and its part in a bilinear average.
struct SeenPixel {
  std::uint32_t pixel;
  float weight;
};

/// What another frame of a shot says of a pixel.
struct Saying {
  const std::uint16_t* values;  ///< Findings::values
  const float* weights;         ///< by channel
  const float* units;           ///< by channel, those of the frame over one's own
  int first, count;             ///< of its taps
};

}  // namespace ssdo
