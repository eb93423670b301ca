// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/plane.h"
#include "scene/camera/camera.h"
#include "scene/surfaces.h"

namespace ssdo {

/// Cosine of the angle between normals from which on neighbours may be of one surface: 18 degrees.
constexpr float kOneNormal = 0.95f;

/// Which pixels show the covered object, 1 or 0: a pixel shows one surface, while coverage, 0..1,
/// is antialiased. Pixels with a coverage of 0.99 or more do. A pixel with less does, however
/// little, unless its surface is that of a neighbouring pixel without any coverage: so the rim of a
/// thing before the sky, wires and hair are whole, and the ground beside them is left out. A pixel
/// without a surface does from a coverage of one half on. Both planes are of the same pixels.
Plane<unsigned char> covered_pixels(const Surfaces& surfels, const Camera& camera,
                                    const Plane<float>& coverage);

}  // namespace ssdo
