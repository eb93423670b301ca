// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "filters/shot/findings.h"
#include "scene/light/light.h"

namespace ssdo {

/// Fills the planes of `products` that take_findings() has left empty with the mean of what a frame
/// and others of its shot have found of the same points; see fusion.cpp. `light` is in the camera
/// space of the frame. Others without a world, or with other planes, say nothing. The same bits for
/// the same frames in the same order.
void fuse(const Findings& own, const std::vector<const Findings*>& others, const Light& light,
          Products& products);

}  // namespace ssdo
