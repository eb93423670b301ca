// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/plane.h"
#include "scene/geometry.h"

namespace ssdo {

/// Pixels in x and in y within which something is near.
constexpr int kNearMoving = 24;

/// 1 in the pixels of `now` that are near something that moved since the frame before, at its old
/// or its new place, over the window of `now`; see near_moving.cpp. Both need `world_known`.
Plane<unsigned char> near_moving(const Geometry& before, const Geometry& now);

}  // namespace ssdo
