// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "support/analytic_scene.h"

namespace ssdo::test {

/// P and N as renderers that average them make a picture: the mean over n x n samples of a pixel,
/// background among them as 0. Pixels whose samples differ in surface are marked in `averaged`.
Picture average_picture(const Surface& scene, const Camera& camera, const Window& window, int n,
                        Plane<unsigned char>& averaged);

}  // namespace ssdo::test
