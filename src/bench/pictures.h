// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "color/color.h"
#include "metrics/difference.h"
#include "relight/frame.h"

namespace ssdo {

/// Makes the PNG files of a page: products as a display shows them, and maps of their error. Large
/// frames are reduced by taking every n-th pixel, since averaging neighbours would hide the noise.
class BenchPictures {
 public:
  BenchPictures(const Frame& frame, const ColorOptions& color);

  /// The bytes of a PNG.
  std::string picture_of(const std::string& product, const Channels& channels) const;

  /// Grey: 1/2 where A is as B, black and white where its luminance is lower and higher by `scale`.
  std::string map_of(const ChannelsDifference& difference, double scale) const;

 private:
  std::string encode(const std::string& product, const Products& products) const;

  const Frame& frame_;
  DisplayTransform display_;
};

}  // namespace ssdo
