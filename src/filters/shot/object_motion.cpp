// SPDX-License-Identifier: Apache-2.0
#include "filters/shot/object_motion.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>

#include "filters/continuity.h"
#include "filters/shot/shot_reprojection.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

/// The place to which the cameras alone move a pixel.
glm::dvec2 by_cameras(const CameraChange& change, const KeptSurfaces& now, std::size_t i) {
  return change.place(change.position(now.pixels[i].position)) - now.centre(i);
}

bool contradicts_cameras(const Plane<glm::vec2>& layer, const KeptSurfaces& now,
                         const KeptSurfaces& before) {
  const ShotReprojection reprojection(before, now);
  const CameraChange change(now.camera, before.camera);
  MotionRatios ratios;
  for_each_points_of_grid(now, grid_step(now), [&](const RowOfPixels& row) {
    RowOfPoints points;
    ReprojectedPoints sights;
    load_points(now, row, points);
    if (!reprojection.find(points, sights)) return;
    for (int i = 0; i < row.count; ++i) {
      const int x = row.x + i * row.step;
      if (sights.pixel[i] >= 0)
        ratios.add(glm::dvec2(layer(x, row.y)), by_cameras(change, now, now.index(x, row.y)));
    }
  });
  return ratios.contradict();
}

}  // namespace

glm::vec3 velocity_of(const ObjectMotion& motion, const KeptSurfaces& now, std::size_t pixel) {
  const glm::dvec2 back = motion.at(pixel);
  if (!std::isfinite(back.x) || !std::isfinite(back.y)) return glm::vec3(0);
  const Camera& camera = now.camera;
  const double scale = camera.orthographic ? 1.0 : double(-now.pixels[pixel].position.z);
  return glm::vec3(-back.x * scale / camera.fx, back.y * scale / camera.fy, 0);
}

ObjectMotion find_object_motion(const Plane<glm::vec2>& layer, const KeptSurfaces& now,
                                const KeptSurfaces& before) {
  ObjectMotion motion;
  if (!now.world_known || !before.world_known) return motion;
  motion.contradicts = contradicts_cameras(layer, now, before);
  if (motion.contradicts) return motion;
  motion.is_known = true;
  motion.pixels.assign(now.size(), 0.0f);
  const CameraChange change(now.camera, before.camera);
  std::atomic<bool> moves = false;
  for_each_row(layer.height, [&](int y) {
    for (int x = 0; x < layer.width; ++x) {
      const std::size_t i = now.index(x, y);
      if (!std::isfinite(now.pixels[i].position.z)) continue;
      const glm::vec2 own(glm::dvec2(layer(x, y)) - by_cameras(change, now, i));
      motion.pixels[i] = pack_bf16x2(own.x, own.y);
      if (glm::length(own) > ObjectMotion::kLeast) moves = true;
    }
  });
  if (!moves) motion.pixels = {};
  return motion;
}

}  // namespace ssdo
