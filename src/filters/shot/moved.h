// SPDX-License-Identifier: Apache-2.0
//
// What moves between two frames of a shot.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "filters/shot/kept_surfaces.h"
#include "filters/shot/own_motion.h"

namespace ssdo {

/// A piece of a surface that stands in one of two frames and not in the other, as a ball.
struct MovedPiece {
  glm::vec3 centre;  ///< camera space
  float radius;      ///< scene units
  float area;        ///< across the view in which it stands
  /// In the frame in which it stands, as far as motion tells: velocity_of().
  glm::vec3 velocity{0};
};

/// The pieces that stand in the frame `stands` and that `looks` looks through, in the camera space
/// of `stands`, to which `motion` belongs. None where one of the frames does not know the world.
std::vector<MovedPiece> find_pieces(const KeptSurfaces& stands, const KeptSurfaces& looks,
                                    const OwnMotion& motion = {});

/// All that moved between two frames, in the camera space of `now`: `gone` are
/// find_pieces(now, other), `come` are find_pieces(other, now).
std::vector<MovedPiece> moved_pieces(const Camera& now, const Camera& other,
                                     std::vector<MovedPiece> gone,
                                     const std::vector<MovedPiece>& come);

}  // namespace ssdo
