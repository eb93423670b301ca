// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <string>

#include "math/plane.h"

namespace ssdo {

/// An image without a colour transform, turned as its file says.
struct Image {
  Plane<glm::vec3> color;   ///< the first three channels, or one as grey
  Plane<float> alpha;       ///< empty where there is none
  bool integers = false;    ///< stored as integers, which become 0..1
  std::string color_space;  ///< that the file names, as OpenImageIO calls it; empty: none
};

/// Takes the next rows of an image, from its row `first` on. `image` has its size and what its file
/// says of it, but no pixels.
using TakeRows = std::function<void(const Image& image, int first, const Plane<glm::vec3>& rows)>;

/// What a display image is stored as.
struct ImageSpec {
  int width = 0, height = 0;
  int channels = 3;        ///< 1 grey, 3 RGB, 4 RGB and unassociated alpha
  int bits = 8;            ///< 8 or 16 per channel; JPEG is always 8
  float pixel_aspect = 1;  ///< width of a pixel over its height
};

}  // namespace ssdo
