// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "io/exr/exr_reader.h"
#include "math/plane.h"

namespace ssdo {

/// What a deep image holds of one place on the view ray of a pixel, as stored: a surface, or a
/// stretch of a medium.
struct DeepSample {
  float front = 0, back = 0;  ///< depths, of the kind and unit of the file; equal for a surface
  float alpha = 1;            ///< share of the light that it stops
};

/// The samples of all pixels, in the order of the file.
struct DeepImage {
  std::string file;
  Window window, display;
  bool half = false;               ///< whether depths are stored with 16 bits
  std::vector<std::size_t> first;  ///< of each pixel of the window, row by row, and the end
  std::vector<DeepSample> samples;

  /// The samples of pixel (x, y); none outside of the window.
  std::span<const DeepSample> at(int x, int y) const {
    if (!window.contains(x, y)) return {};
    const std::size_t i =
        std::size_t(y - window.y0) * std::size_t(window.width()) + std::size_t(x - window.x0);
    return {samples.data() + first[i], first[i + 1] - first[i]};
  }
};

/// A channel of a deep part.
struct DeepChannel {
  int part = 0;
  std::string name;  ///< in full; empty: there is none
};

/// The channels of a deep image that say where something is. Without `back` every sample is a
/// surface, without `alpha` it is opaque.
struct DeepChannels {
  DeepChannel front, back, alpha;
};

/// Reads the samples of deep parts, in scanlines or tiles (their full-resolution level). Channels
/// may stand in several parts that hold as many samples in each pixel.
/// Errors: ExitCode::input for a file that is damaged, whose samples exceed the memory, or whose
/// parts do not hold the same samples.
DeepImage read_deep(const ExrReader& file, const DeepChannels& channels);

}  // namespace ssdo
