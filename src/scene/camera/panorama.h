// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "math/plane.h"
#include "scene/camera/camera.h"

namespace ssdo {

/// Finds the lat-long panorama of all directions under which every position projects to the centre
/// of its own pixel: `display` is 2 pi wide and pi high. Its longitude may grow to the left, and
/// its poles may point anywhere.
///
/// Returns nothing where no panorama brings half of the positions within half a pixel of their own.
/// `positions` are over `window`; a pixel takes part where `valid` is not 0.
std::optional<Camera> fit_panorama(const Plane<glm::vec3>& positions,
                                   const Plane<unsigned char>& valid, const Window& window,
                                   const Window& display);

}  // namespace ssdo
