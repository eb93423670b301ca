// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "math/plane.h"
#include "scene/geometry.h"

namespace ssdo {

/// A sphere around the camera and all that a frame shows, far from it: a sky dome.
struct Backdrop {
  Plane<float> coverage;  ///< 1 in pixels that show it
  double share = 0;       ///< of the frame's pixels
  double radius = 0;      ///< scene units
};

/// The sky dome of a frame; nothing where it shows none (backdrop.cpp).
std::optional<Backdrop> find_backdrop(const Geometry& geometry);

}  // namespace ssdo
