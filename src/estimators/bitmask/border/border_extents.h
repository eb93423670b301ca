// SPDX-License-Identifier: Apache-2.0
//
// How far surfaces that the frame's border cuts are seen, and so how far they may go on beyond it.
//
// Nothing shows where such a surface ends, but the border cuts it at a place that has nothing to do
// with its size: what is seen over a length L goes on for about as much more (Gott 1993,
// Implications of the Copernican principle for our future prospects). A wall of which five pixels
// are seen is expected to end soon; the front of a street goes on.
//
// A surface spans a part of its tangent plane along two axes, one horizontal and one uphill. Upward
// things end sooner than sideways: walls, fences and rows of houses are longer than they are high.
// So a sun that stands well above all that is seen of a wall is taken to be seen.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "estimators/bitmask/march_scene.h"

namespace ssdo {

/// What a pixel at the border shows, how far it is seen from there, and how much farther it may go
/// on at most: scene units along the axes of its tangent plane, to the right, to the left, uphill,
/// downhill.
struct BorderExtent {
  float depth = 0;      ///< as MarchLayer has it
  glm::vec3 normal{0};  ///< of the tangent plane
  float seen[4] = {}, most[4] = {1, 1, 1, 1};
};

/// The surfaces that the border of a frame cuts.
struct CutSurfaces {
  glm::vec3 up{0, 1, 0};              ///< unit, camera space
  std::vector<BorderExtent> extents;  ///< by the index of BorderLayout
};

/// Whether rays may meet the tangent plane of a border pixel, at this position and with this unit
/// normal, from its front.
using MayMeetPlane = std::function<bool(const glm::vec3& position, const glm::vec3& normal)>;

/// Extents are measured within `radius` of each pixel, where `may_meet` says so; null: everywhere.
CutSurfaces find_cut_surfaces(const MarchScene& scene, const glm::vec3& up, float radius,
                              const MayMeetPlane& may_meet = {});

/// The horizontal axis of a plane is cross(up, normal) plus this, made unit across the normal:
/// level planes have one too.
inline constexpr glm::vec3 kAxisOfLevelPlanes{1e-3f, 5e-4f, 2e-4f};

}  // namespace ssdo
