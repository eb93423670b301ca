// SPDX-License-Identifier: Apache-2.0
#include "prior/prior_grid.h"

#include <cmath>

#include "estimators/guessed.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

/// About how many squares a frame is wide, and the largest side of a square in pixels: at least one
/// pixel of 16 is looked at.
constexpr double kLookedAt = 480;
constexpr int kLargest = 4;

int floor_div(int a, int b) { return int(std::floor(double(a) / b)); }

/// The place, along one side of a square, of the pixel that stands for it: 8 squares in a row take
/// 8 different columns of the sampling pattern.
int place_in(int square, int step) {
  constexpr int kPeriod = kGuessedPattern;
  const int turn = (square & (kPeriod - 1)) * step / kPeriod;
  return turn & (step - 1);
}

}  // namespace

int prior_cell_size(int display_width) {
  const int wanted = int(std::lround(display_width / kLookedAt));
  return wanted >= kLargest ? kLargest : wanted >= 2 ? 2 : 1;
}

PriorGrid make_prior_grid(const Geometry& geometry, const Window& part,
                          const CasterSurfaces* casting) {
  const auto shows_surface = [&](std::size_t pixel) {
    return geometry.surfaces[pixel].is_usable() &&
           (!casting || casting->geometry.surfaces[pixel].is_usable());
  };
  PriorGrid s;
  const int step = s.step = prior_cell_size(geometry.display.width());
  // The place of the geometry's first pixel in the display window.
  const int left = geometry.window.x0 - geometry.display.x0,
            top = geometry.window.y0 - geometry.display.y0;
  s.first = {floor_div(left + part.x0, step), floor_div(top + part.y0, step)};
  s.display = {floor_div(geometry.display.width() - 1, step) + 1,
               floor_div(geometry.display.height() - 1, step) + 1};
  const int width = floor_div(left + part.x1 - 1, step) + 1 - s.first.x,
            height = floor_div(top + part.y1 - 1, step) + 1 - s.first.y;
  s.pixel = Plane<std::int32_t>(width, height, kNoPixel);
  s.covered = Plane<float>(width, height, 0.0f);
  s.surfaces = Surfaces(width, height);
  for_each_row(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const int x0 = (s.first.x + x) * step - left, y0 = (s.first.y + y) * step - top;
      const auto take = [&](int px, int py) {
        if (!part.contains(px, py) || !shows_surface(geometry.surfaces.index(px, py))) return false;
        s.pixel(x, y) = std::int32_t(geometry.surfaces.index(px, py));
        s.surfaces.set(x, y, geometry.surfaces(px, py));
        return true;
      };
      if (take(x0 + place_in(s.first.x + x, step), y0 + place_in(s.first.y + y, step))) {
        s.covered(x, y) = 1;
        continue;
      }
      for (int k = 0; k < step * step; ++k)
        if (take(x0 + k % step, y0 + k / step)) break;
    }
  });
  return s;
}

}  // namespace ssdo
