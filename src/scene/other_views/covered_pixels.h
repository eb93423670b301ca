// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/plane.h"
#include "scene/camera/camera.h"
#include "scene/surfel.h"

namespace ssdo {

/// Cosine of the angle between normals from which on neighbours may be of one surface: 18 degrees.
constexpr float kOneNormal = 0.95f;

/// Which pixels show what is covered, 1 or 0: a pixel shows one surface, while coverage, 0..1, is
/// antialiased. All from 0.99 on do. What is covered in part does, however little, unless it lies
/// on the surface of a pixel beside it that is not covered at all: so the rim of a thing before the
/// sky, wires and hair are whole, and the ground beside them is not theirs. Where there is no
/// surface, half of the pixel counts. Both planes are of the same pixels.
Plane<unsigned char> covered_pixels(const Plane<Surfel>& surfels, const Camera& camera,
                                    const Plane<float>& coverage);

}  // namespace ssdo
