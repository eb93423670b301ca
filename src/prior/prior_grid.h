// SPDX-License-Identifier: Apache-2.0
//
// The coarse grid on which the prior works. Squares of pixels are counted from the first pixel of
// the display window, so that they are the same for any crop. One pixel stands for each square. Its
// place changes from square to square, so that the pixels of 8 x 8 squares together take the
// directions of every member of the sampling pattern (estimators/bitmask/slice_pattern.h).
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "math/plane.h"
#include "scene/scene.h"

namespace ssdo {

/// What the prior looks at, by square; 0 or not a surface where a square shows none.
struct PriorGrid {
  int step = 1;        ///< pixels on each side: 1, 2 or 4
  glm::ivec2 first;    ///< number of the first square
  glm::ivec2 display;  ///< squares that the display window takes, which begins at square (0, 0)
  Plane<std::int32_t> pixel;  ///< that stands for the square, in the geometry; or kNoPixel
  Plane<float> covered;       ///< 1: the chosen pixel shows a surface; 0: another pixel, or none
  Surfaces surfaces;          ///< that the pixel shows
  // After the mean over squares.
  Plane<float> ao, open_ao;       ///< ao, and the ao if surfaces end at the border
  Plane<float> guesses, guessed;  ///< G of estimators/guessed.h, and its product with ao
  Plane<glm::vec3> bent;          ///< unit, camera space

  bool in_display(int x, int y) const {
    const int column = first.x + x, row = first.y + y;
    return column >= 0 && row >= 0 && column < display.x && row < display.y;
  }
};

/// Pixels on each side of a square, for frames that are so many pixels wide.
int prior_cell_size(int display_width);

/// Divides `part` of a geometry's window, which is in pixels of the window, into squares. A surface
/// that casts nothing and has nothing behind it, such as a dome around the scene, counts as sky.
/// `casting`: of the geometry's scene, or null.
PriorGrid make_prior_grid(const Geometry& geometry, const Window& part,
                          const CasterSurfaces* casting = nullptr);

}  // namespace ssdo
