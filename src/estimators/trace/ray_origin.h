// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>

#include "estimators/trace/ray_scene.h"
#include "scene/surfel.h"

namespace ssdo {

/// How the surface of a pixel lies.
struct Stand {
  glm::vec3 normal;  ///< of the geometry, unit
  glm::vec3 view;    ///< unit, to the viewer
  float footprint;   ///< width of what the pixel shows, in scene units
};

/// Where the rays of a pixel start, in camera space: a little above its surface, and as much before
/// all triangles on the way to the viewer.
///
/// Triangles lead from the middle of a pixel to the middles of its neighbours. A step along the
/// normal leads behind them where a neighbour leans over the pixel, and along them where the pixel
/// shows the very edge between its wall and another: it hid 0.05 to 0.6 % of the pixels of frames
/// from Cycles from the viewer who sees them.
glm::dvec3 ray_origin(const RayScene& rays, const Surfel& surfel, const Stand& stand);

}  // namespace ssdo
