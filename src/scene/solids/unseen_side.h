// SPDX-License-Identifier: Apache-2.0
//
// The hidden side of a body faces as the surface does that the ends of the view rays in it form
// (depth_across.cpp), where that bends away from the visible side: so a box has the hidden sides
// that its depth says, each as large as it is. With the mirror image for all bodies, the top of a
// box that is seen at a flat angle sent its light twice, as its image faces up too, and a side at
// which view rays leave faced away from the camera instead. Relative error of the bounce of nine
// lamps, frame alone, and with overscan and four views: 0.550 and 0.455 with the image, 0.530
// and 0.438 with what the ends form. With slopes over three pixels in place of one, 0.538 and
// 0.445; and the light of a box in tests/estimators/bitmask/unseen_side_test.cpp is off by 0.32 for
// 0.26.
//
// Elsewhere, the hidden side is taken for the mirror image of the visible one in a plane across the
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

/// What the next pixel's point may leave the tangent plane of a pixel by, in widths of a pixel,
/// where slopes are found: a ball 50 pixels wide does so in its middle. Smaller balls, and all
/// rims, have no slope that two pixels could tell, and their mirror image is right.
constexpr float kMostCurve = 0.02f;

/// The least slope of the ends of view rays against the visible side, in widths of a pixel per
/// pixel: with less, both sides are nearly parallel. A ball has this slope at an eighth of its
/// radius from its middle, where its mirror image faces as the ends of the rays do.
constexpr float kLeastBend = 0.25f;

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
