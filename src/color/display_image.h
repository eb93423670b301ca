// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "color/color.h"
#include "color/compose.h"
#include "io/images/image_file.h"

namespace ssdo {

/// A product as a display shows it: interleaved values in 0..1 over the display window.
struct DisplayImage {
  int width = 0, height = 0, channels = 3;
  float pixel_aspect = 1;
  std::vector<float> values;

  ImageSpec spec(int bits) const { return {width, height, channels, bits, pixel_aspect}; }
};

/// How a display shows products.
struct DisplayFormat {
  const DisplayTransform* transform = nullptr;  ///< of light; may be null for all other products
  bool alpha = true;  ///< whether the image may have an alpha channel; else it lies over black
};

/// Whether a product is light, which goes through the display transform; visibility does not.
bool needs_display(const std::string& product);

/// Light becomes colours of the display. The composite keeps its alpha and is not premultiplied; or
/// it lies over black, premultiplied before the display transform, as compositors show and convert
/// a premultiplied EXR. Where its alpha is 0, colours are as they are. Directions become RGB with
/// 1/2 for 0; other data stay as they are. Pixels outside the data window are empty.
DisplayImage make_display_image(const std::string& name, const Results& results,
                                const DisplayFormat& format);

}  // namespace ssdo
