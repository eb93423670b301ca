// SPDX-License-Identifier: Apache-2.0
//
// The hidden side of a body is taken for the mirror image of the visible one in a plane across the
// view ray. This is right for a ball, and for a box that shows two sides alike. The image of a
// point near the ground is near the ground too: with the point opposite to the pixel and the normal
// reversed, a ball's upper half lit the ground below it. Relative error of the bounce of nine
// lamps, frame alone, and with overscan and four views: 0.69 and 0.73 with the opposite point, 0.66
// and 0.70 with the image. Under environment maps both are alike: 0.467 and 0.471 in five scenes,
// 0.357 and 0.354 of things on a table, 0.140 and 0.137 in a room with overscan.
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "scene/solids/width_of_run.h"

namespace ssdo {

/// The solid of a point may be in the way within so many pixels of it: those beside its own.
constexpr float kBesidePx = 1.5f;

/// The length of the view ray inside a body: for a ball, its width where the ray passes. The
/// guessed thickness (scene/solids/width_of_run.h) is a share of it. Runs of pixels are measured to
/// the middle of the last one. `pixel`: the width of what a pixel shows.
inline float way_through(float thickness, float pixel) {
  return thickness / kDepthOfWidth + 0.5f * pixel;
}

/// The normal of the unseen side; `view`, unit, is the direction to the viewer.
inline glm::vec3 unseen_normal(const glm::vec3& normal, const glm::vec3& view) {
  return normal - 2 * glm::dot(normal, view) * view;
}

}  // namespace ssdo
