// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "math/plane.h"
#include "scene/surfaces.h"

namespace ssdo {

/// P is smooth where three neighbours are on a line to this: see is_straight().
constexpr float kStraight = 0.1f;

/// The unit normal of the geometry at a pixel around which P is smooth: three pixels in a row and
/// three in a column lie on a line each, over distances that the precision of P can tell. Turned to
/// the viewer, who is along `view` from the surface. Nothing elsewhere.
std::optional<glm::vec3> smooth_gradient(const Surfaces& surfels, int x, int y,
                                         const glm::vec3& view);

}  // namespace ssdo
