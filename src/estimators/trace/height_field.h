// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "estimators/trace/picture_space.h"
#include "scene/geometry.h"
#include "scene/solids/solids.h"

namespace ssdo {

/// What a corner of a triangle belongs to.
struct Owner {
  float front = 0;  ///< height of the front that is before this corner, or the corner's own
  int sender = -1;  ///< the pixel that shows this surface; -1: it sends nothing
  int layer = 0;    ///< of the solid
};

/// Triangles with corners in picture space.
struct TriangleMesh {
  std::vector<glm::vec3> corners;
  std::vector<Owner> owners;  ///< of the corners
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// The solids of a frame: fronts and backs of all layers, and walls between front and back along
/// the view rays wherever a surface is cut.
struct HeightField {
  PictureSpace space;
  TriangleMesh sheets;  ///< fronts and backs, with a corner at the centre of each pixel
  TriangleMesh cuts;    ///< the quarters of pixels around every cut, and its walls
};

HeightField build_height_field(const Geometry& geometry, const Solids& solids);

}  // namespace ssdo
