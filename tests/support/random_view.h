// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "support/analytic_scene.h"
#include "support/random_numbers.h"

namespace ssdo::test {

/// A point of a surface that a pixel shows, or none. The normal is on the viewer's side.
struct SeenPoint {
  bool surface = false;
  glm::dvec3 position{0}, normal{0};
};

/// Windows and a lens: a camera at the origin that looks along -z.
struct RandomLens {
  Window data, display;
  double pixel_aspect = 1;
  Camera camera;
  bool is_centred = true;  ///< the principal point is the middle of the display window
};

/// A picture of up to 24 x 16 pixels: its data window beside, within or around the display window;
/// perspective of 1 to 170 degrees, or none; sometimes shifted.
RandomLens random_lens(RandomNumbers& random);

/// The same view in `times` as many rows and columns.
RandomLens finer(RandomLens lens, int times);

/// One to six things before a lens: balls, boxes, planes at any angle and grazing ones, strips
/// below a pixel's width, stairs, layers that all but touch, and rooms around the camera.
Surface random_world(RandomNumbers& random, const RandomLens& lens);

/// What the pixels of a lens show whose space is turned and moved from that of the world, in the
/// space of the world.
Plane<SeenPoint> look(const Surface& world, const RandomLens& lens,
                      const glm::dmat3& to_world = glm::dmat3(1),
                      const glm::dvec3& eye = glm::dvec3(0));

/// A rotation, any as likely as another.
glm::dmat3 random_rotation(RandomNumbers& random);

}  // namespace ssdo::test
