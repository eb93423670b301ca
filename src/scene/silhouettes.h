// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "scene/geometry.h"

namespace ssdo {

/// Moves pixels whose P is an average over an edge onto one of the surfaces beside them, see
/// silhouettes.cpp, and gives them its normal. `residual` says how well all of P keeps to its
/// pixels, `is_filtered` that P is known to be filtered. Returns how many pixels were moved.
std::size_t mend_silhouettes(Geometry& geometry, const Residual& residual,
                             bool is_filtered = false);

}  // namespace ssdo
