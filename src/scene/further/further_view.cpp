// SPDX-License-Identifier: Apache-2.0
#include "scene/further/further_view.h"

#include <cmath>
#include <glm/matrix.hpp>
#include <utility>

#include "parallel/tiles.h"
#include "scene/view.h"

namespace ssdo {
namespace {

/// Depths that differ by less than so many footprints are of one surface, tilted as it may be.
constexpr float kSightGap = 3;

/// A view shows what is so many of its pixels wide wherever these fall. With 0, leaves that views
/// look past were carved away: ao of foliage at the small radius .18 in place of .09.
constexpr float kResolved = 3;

/// The camera that takes points of the frame's camera space to those of `view`'s.
Camera seen_from(const Camera& view, const Camera& frame) {
  Camera camera = view;
  camera.rotation = view.rotation * glm::transpose(frame.rotation);
  camera.origin = frame.to_camera(view.origin);
  return camera;
}

}  // namespace

FurtherView place(FurtherPictures::Picture picture, const Geometry& frame) {
  const Camera camera = seen_from(picture->camera, frame.camera);
  return {std::move(picture), camera};
}

Plane<Surfel> FurtherView::surfels_in_frame() const {
  Plane<Surfel> placed = surfel;
  const glm::dmat3 to_frame = glm::transpose(camera.rotation);
  for_each_row(placed.height, [&](int y) {
    for (int x = 0; x < placed.width; ++x) {
      Surfel& s = placed(x, y);
      if (!s.is_surface()) continue;
      s.position = glm::vec3(to_frame * glm::dvec3(s.position) + camera.origin);
      s.normal = glm::vec3(to_frame * glm::dvec3(s.normal));
    }
  });
  return placed;
}

Sight FurtherView::look(const glm::vec3& point, float width) const {
  const glm::dvec3 own = camera.to_camera(glm::dvec3(point));
  const double depth_here = camera.depth_of(own);
  if (!camera.orthographic && !(depth_here > 0)) return Sight::unknown;
  const float pixel = footprint(float(depth_here));
  if (!(width > kResolved * pixel)) return Sight::unknown;
  const glm::dvec2 at = camera.project(own);
  const double left = std::floor(at.x - window.x0 - 0.5), top = std::floor(at.y - window.y0 - 0.5);
  const int w = surfel.width, h = surfel.height;
  if (!(top >= 0 && top + 1 < h)) return Sight::unknown;
  if (!closed && !(left >= 0 && left + 1 < w)) return Sight::unknown;
  const float gap = kSightGap * pixel;
  int beyond = 0, before = 0;
  for (int k = 0; k < 4; ++k) {
    const int x = (int(left) + k % 2 + w) % w, y = int(top) + k / 2;
    const float shown = depth(x, y);
    beyond += shown > float(depth_here) + gap;
    before += shown < float(depth_here) - gap;
  }
  if (before > 0) return Sight::unknown;
  return beyond == 4 ? Sight::empty : Sight::surface;
}

}  // namespace ssdo
