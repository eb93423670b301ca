// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "scene/surfaces.h"

namespace ssdo {

/// What pixel (x, y) shows; nothing outside of the frame or where that is no surface.
std::optional<Surfel> surface_at(const Surfaces& surfels, int x, int y);

/// The unit normal of the surface through pixel (x, y), from its neighbours, turned to the viewer,
/// who looks along `view` from the surface. Along each axis the shorter of the two one-sided
/// differences is used, which stays on the pixel's own side of an edge; where both neighbours show
/// nothing, the next ones are asked. Zero where the neighbours span no plane, or are so near or far
/// that float has no square of its area.
glm::vec3 gradient_normal(const Surfaces& surfels, int x, int y, const glm::vec3& view);

/// Unit direction from a camera-space point, which is not where the viewer is, to the viewer.
inline glm::vec3 direction_to_viewer(const glm::vec3& p, bool orthographic) {
  if (orthographic) return glm::vec3(0, 0, 1);
  // The square of a very small or large distance is none in float.
  if (!std::isnormal(glm::dot(p, p))) return -glm::vec3(glm::normalize(glm::dvec3(p)));
  return -glm::normalize(p);
}

}  // namespace ssdo
