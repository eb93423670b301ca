// SPDX-License-Identifier: Apache-2.0
#include "scene/other_views/other_view.h"

#include <glm/matrix.hpp>
#include <utility>

#include "parallel/tiles.h"

namespace ssdo {

Camera seen_from(const Camera& view, const Camera& frame) {
  Camera camera = view;
  camera.rotation = view.rotation * glm::transpose(frame.rotation);
  camera.origin = frame.to_camera(view.origin);
  return camera;
}

OtherView place(OtherView::Picture picture, const Geometry& frame) {
  const Camera camera = seen_from(picture->camera, frame.camera);
  return {std::move(picture), camera};
}

Surfaces OtherView::surfels_in_frame() const {
  Surfaces placed = picture->surfaces;
  const glm::dmat3 to_frame = glm::transpose(camera.rotation);
  for_each_row(placed.height, [&](int y) {
    for (int x = 0; x < placed.width; ++x) {
      Surfel s = placed(x, y);
      if (!s.is_surface()) continue;
      s.position = glm::vec3(to_frame * glm::dvec3(s.position) + camera.origin);
      s.normal = glm::vec3(to_frame * glm::dvec3(s.normal));
      placed.set(x, y, s);
    }
  });
  return placed;
}

}  // namespace ssdo
