// SPDX-License-Identifier: Apache-2.0
//
// What moves between two frames of a shot.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "filters/shot/kept_surfaces.h"

namespace ssdo {

/// A piece of a surface that stands in one of two frames and not in the other, as a ball.
struct MovedPiece {
  glm::vec3 centre;  ///< camera space
  float radius;      ///< scene units
  float area;        ///< across the view in which it stands
};

/// Those that stand in one frame and that the other looks through, in the camera space of the
/// first. None where one of them does not know the world.
std::vector<MovedPiece> find_pieces(const KeptSurfaces& stands, const KeptSurfaces& looks);

/// All that moved between two frames, in the camera space of `now`: `gone` are
/// find_pieces(now, other), `come` are find_pieces(other, now).
std::vector<MovedPiece> moved_pieces(const Camera& now, const Camera& other,
                                     std::vector<MovedPiece> gone,
                                     const std::vector<MovedPiece>& come);

}  // namespace ssdo
