// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "math/plane.h"
#include "scene/surfaces.h"

namespace ssdo {

/// The unit normal of the surface itself, whatever a normal map or smooth shading says: from the
/// positions around a usable pixel where these lie on a smooth surface and rounding leaves them a
/// slope; else, and within two degrees of it, the normal of the pixel. `view` is the direction to
/// the viewer.
glm::vec3 geometric_normal(const Surfaces& surfels, int x, int y, const glm::vec3& view);

/// The same of every pixel of a row that shows a surface, in a fraction of the time.
void find_geometric_normals(const Surfaces& surfels, int y, bool orthographic,
                            std::span<glm::vec3> normals);

}  // namespace ssdo
