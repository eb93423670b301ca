// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/plane.h"

namespace ssdo {

/// Which pixels of a frame outputs leave alone, 0..1 by coverage, over the window of its G-buffer.
struct ObjectMasks {
  Plane<float> kept;      ///< stay as they were rendered, and open; empty: none
  Plane<float> held_out;  ///< have alpha 0 in the composite; empty: none
};

}  // namespace ssdo
