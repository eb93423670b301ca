// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "estimators/view_space/picture_space.h"
#include "scene/geometry.h"
#include "scene/hidden_geometry.h"

namespace ssdo {

/// What a corner of a triangle belongs to.
struct Owner {
  float front = 0;       ///< height of the front that is before this corner, or the corner's own
  int pixel = -1;        ///< that shows this surface
  bool covered = false;  ///< here it goes on behind something else
};

/// Triangles with corners in picture space.
struct TriangleMesh {
  std::vector<glm::vec3> corners;
  std::vector<Owner> owners;  ///< of the corners
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// The frame as thick solids: the fronts that it shows, the surfaces that go on behind them, their
/// backs, and walls between front and back along the view rays wherever a surface is cut.
struct HeightField {
  PictureSpace space;
  TriangleMesh sheets;  ///< fronts and backs, with a corner at the centre of each pixel
  TriangleMesh cuts;    ///< the quarters of pixels around every cut, and its walls
};

/// `hidden` may be empty: then all that is seen is endless, and covers nothing.
HeightField build_height_field(const Geometry& geometry, const HiddenGeometry& hidden);

}  // namespace ssdo
