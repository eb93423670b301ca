// SPDX-License-Identifier: Apache-2.0
//
// A point of one frame has moved if the other frame looks through its place: all pixels around that
// place show a surface that is farther away by kBehind of its depth, or nothing. An edge between
// the pixels of one frame passes this test too, but only in lines one pixel wide: a point counts if
// kLeast - 1 of its eight neighbours pass too.
//
// The filters in filters/ have similar rules of their own.
#include "metrics/near_moving.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/matrix.hpp>
#include <vector>

#include "parallel/tiles.h"
#include "scene/camera/camera_change.h"

namespace ssdo {
namespace {

constexpr double kBehind = 0.02, kLeastPart = 1e-3;
constexpr int kLeast = 4;

/// From the camera space of one frame to the pixels of another.
struct OtherFrame {
  OtherFrame(const Geometry& other, const Geometry& own)
      : geometry(other), change(own.camera, other.camera) {}

  const Geometry& geometry;
  CameraChange change;

  /// Whether the other frame looks through the place of `surfel`, a point of the own frame.
  bool looks_through(const Surfel& surfel) const {
    if (!surfel.is_usable()) return false;
    const glm::dvec3 p = change.position(surfel.position);
    if (!geometry.camera.orthographic && p.z >= 0) return false;
    const glm::dvec2 place = geometry.camera.project(p);
    const glm::dvec2 corner = glm::floor(place - 0.5), past = place - 0.5 - corner;
    const Window& window = geometry.window;
    if (!(corner.x >= window.x0 && corner.x + 1 < window.x1 && corner.y >= window.y0 &&
          corner.y + 1 < window.y1))
      return false;
    const int left = int(corner.x), top = int(corner.y);
    for (int k = 0; k < 4; ++k) {
      // With a camera at rest, the neighbours' weights differ from 0 by rounding only.
      const double part = (k % 2 ? past.x : 1 - past.x) * (k / 2 ? past.y : 1 - past.y);
      if (part < kLeastPart) continue;
      const Surfel& q = geometry.surfaces(left + k % 2 - window.x0, top + k / 2 - window.y0);
      if (q.is_broken()) return false;
      if (q.is_surface() && double(q.position.z) > p.z - kBehind * std::abs(p.z)) return false;
    }
    return true;
  }
};

/// 1 in the pixels of `own` whose points have moved.
Plane<unsigned char> moved(const Geometry& own, const Geometry& other) {
  const OtherFrame frame(other, own);
  const int width = own.surfaces.width, height = own.surfaces.height;
  auto through = Plane<unsigned char>::like(own.surfaces);
  for_each_row(height, [&](int y) {
    for (int x = 0; x < width; ++x) through(x, y) = frame.looks_through(own.surfaces(x, y));
  });
  auto out = Plane<unsigned char>::like(own.surfaces);
  for_each_row(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      int count = 0;
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height - 1); ++v)
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width - 1); ++u)
          count += through(u, v);
      out(x, y) = through(x, y) && count >= kLeast;
    }
  });
  return out;
}

/// Marks what is near in x, or in y where `step` is the width of the plane.
void spread(Plane<unsigned char>& plane, int lines, int line, int length, int step) {
  for (int i = 0; i < lines; ++i) {
    unsigned char* first = &plane[std::size_t(i) * std::size_t(line)];
    const auto at = [&](int k) -> unsigned char& { return first[std::ptrdiff_t(k) * step]; };
    std::vector<unsigned char> marked(std::size_t(length), 0);
    for (int k = 0; k < length; ++k)
      if (at(k) != 0)
        std::fill(marked.begin() + std::max(k - kNearMoving, 0),
                  marked.begin() + std::min(k + kNearMoving + 1, length), 1);
    for (int k = 0; k < length; ++k) at(k) = marked[std::size_t(k)];
  }
}

}  // namespace

Plane<unsigned char> near_moving(const Geometry& before, const Geometry& now) {
  Plane<unsigned char> near = moved(now, before);
  const Plane<unsigned char> gone = moved(before, now);
  const OtherFrame frame(now, before);
  for (std::size_t i = 0; i < gone.size(); ++i) {
    if (!gone[i]) continue;
    const glm::dvec2 place = now.camera.project(frame.change.position(before.surfaces[i].position));
    near(int(std::floor(place.x)) - now.window.x0, int(std::floor(place.y)) - now.window.y0) = 1;
  }
  spread(near, near.height, near.width, near.width, 1);
  spread(near, near.width, 1, near.height, near.width);
  return near;
}

}  // namespace ssdo
