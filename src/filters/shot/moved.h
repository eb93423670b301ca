// SPDX-License-Identifier: Apache-2.0
//
// What moves between two frames of a shot, and where that changes light.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "math/plane.h"
#include "scene/geometry.h"
#include "scene/light/light.h"

namespace ssdo {

/// A piece of a surface that stands in one of two frames and not in the other, as a ball.
struct MovedPiece {
  glm::vec3 centre;  ///< camera space of `now`
  float radius;      ///< scene units
  float area;        ///< across the view in which it stands
};

/// Those that `now` shows and `other` looks through, and the other way round. Both know the world.
std::vector<MovedPiece> find_moved(const Geometry& now, const Geometry& other);

/// How much of what another frame says counts at the pixels of `now`; see moved.cpp.
class MovedWeights {
 public:
  MovedWeights(const Geometry& now, const std::vector<MovedPiece>& pieces, const Light& light);

  /// 0..1 for the light of a source by its number, or for all other light, below 0.
  float at(int source, int x, int y) const;

 private:
  Plane<float> of_all_;
  std::vector<Plane<float>> of_sources_;
};

}  // namespace ssdo
