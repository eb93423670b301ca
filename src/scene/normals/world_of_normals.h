// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "scene/camera/metadata/candidates.h"
#include "scene/geometry.h"

namespace ssdo {

/// Lets the stored normals decide on a pose of the header that P cannot prove, P being in camera
/// space or missing. Normals in the world of a reading of `readings`, the first before the others,
/// prove it; normals of another world refute all of them, and the frame stays in camera space.
/// Where they are in camera space or there are none, the first reading holds, with a warning unless
/// the header confirms it. Sets the placement, the finding and the warnings of `report`.
void settle_world(const GBuffer& g, const Surfaces& surfels,
                  const std::vector<HeaderCamera>& readings, GeometryReport& report);

}  // namespace ssdo
