// SPDX-License-Identifier: Apache-2.0
//
// What moves between two frames of a shot.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "filters/shot/kept_surfaces.h"
#include "filters/shot/object_motion.h"

namespace ssdo {

/// A piece of a surface that stands in one of two frames and not in the other, as a ball.
struct MovedPiece {
  glm::vec3 centre;  ///< camera space
  float radius;      ///< scene units
  float area;        ///< across the view in which it stands
  /// In the frame in which it stands, as far as motion tells: velocity_of().
  glm::vec3 velocity{0};
};

/// The pieces that stand in the frame `shown_in` and that `seen_through_by` looks through, in the
/// camera space of `shown_in`, to which `motion` belongs. None where one of the frames does not
/// know the world.
std::vector<MovedPiece> find_pieces(const KeptSurfaces& shown_in,
                                    const KeptSurfaces& seen_through_by,
                                    const ObjectMotion& motion = {});

/// All that moved between two frames, in the camera space of `now`: `disappeared` are
/// find_pieces(now, other), `appeared` are find_pieces(other, now).
std::vector<MovedPiece> moved_pieces(const Camera& now, const Camera& other,
                                     std::vector<MovedPiece> disappeared,
                                     const std::vector<MovedPiece>& appeared);

}  // namespace ssdo
