// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "color/color.h"
#include "estimators/estimator.h"
#include "io/image_file.h"
#include "scene/gbuffer.h"
#include "scene/scene.h"

namespace ssdo {

/// A product as a display shows it: interleaved values in 0..1 over the display window.
struct DisplayImage {
  int width = 0, height = 0, channels = 3;
  float pixel_aspect = 1;
  std::vector<float> values;

  ImageSpec spec(int bits) const { return {width, height, channels, bits, pixel_aspect}; }
};

/// Whether a product is light, which goes through the display transform; visibility does not.
bool needs_display(const std::string& product);

/// Products that are light come as colours of the display. The composite comes with its alpha, not
/// premultiplied, or, where `with_alpha` is false, over black: premultiplied before the display
/// transform, as light adds up, which is how compositors show and convert a premultiplied EXR.
/// Directions come as RGB with 1/2 for 0, all else as grey. What the data window does not cover is
/// empty. `display` may be null where needs_display is false.
DisplayImage make_display_image(const std::string& name, const Scene& scene, const GBuffer& gbuffer,
                                const Products& products, const DisplayTransform* display,
                                bool with_alpha);

}  // namespace ssdo
