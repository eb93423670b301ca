// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "support/analytic_scene.h"
#include "support/deep_file.h"

namespace ssdo::test {

/// What a renderer writes for elements that it renders apart and merges: the first surface of each
/// on every pixel's ray, by planar depth, in the order of the elements.
DeepPixels merged(const std::vector<Surface>& elements, const Camera& camera, const Window& window);

}  // namespace ssdo::test
