// SPDX-License-Identifier: Apache-2.0
//
// A slab that floats over a ground, with a ball beside it: the front faces of this scene, and the
// back faces that are left where the front ones are culled.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "support/boxes.h"
#include "support/frame_file.h"

namespace ssdo::test {

inline const Window kFrame{0, 0, 160, 120};
inline const Box kSlab{{-1, -0.8, 0.7}, {0.8, 0.6, 0.85}};
inline const glm::dvec3 kEye(0.5, -4, 3), kTarget(0, 0, 0.3), kBall(1.5, 0.8, 0.5);
inline constexpr double kBallRadius = 0.4;

/// What is left of a box when its front faces are culled.
inline Surface back_of(const Box& box) {
  return [box](const Ray& ray) -> std::optional<Hit> {
    const auto [enter, leave] = box.cross(ray);
    if (enter > leave || leave < 1e-9) return std::nullopt;
    const glm::dvec3 p = ray.origin + leave * ray.direction;
    Hit hit{leave, glm::dvec3(0)};
    for (int c = 0; c < 3; ++c) {
      if (std::abs(p[c] - box.low[c]) < 1e-9) hit.normal[c] = -1;
      if (std::abs(p[c] - box.high[c]) < 1e-9) hit.normal[c] = 1;
    }
    hit.normal = glm::normalize(hit.normal);
    return hit;
  };
}

/// How far a ray goes through a ball: none where it is missed.
inline std::optional<double> chord(const glm::dvec3& centre, double radius, const Ray& ray) {
  const glm::dvec3 way = centre - ray.origin, along = glm::normalize(ray.direction);
  const double middle = glm::dot(way, along),
               half2 = radius * radius - glm::dot(way, way) + middle * middle;
  if (half2 <= 0) return std::nullopt;
  return 2 * std::sqrt(half2);
}

inline Surface back_of_ball() {
  return [](const Ray& ray) -> std::optional<Hit> {
    const auto front = sphere(kBall, kBallRadius)(ray);
    const auto through = chord(kBall, kBallRadius, ray);
    if (!front || !through) return std::nullopt;
    const double t = front->distance + *through / glm::length(ray.direction);
    return Hit{t, glm::normalize(ray.origin + t * ray.direction - kBall)};
  };
}

inline Surface scene() {
  return all_of({plane({}, {0, 0, 1}), kSlab.surface(), sphere(kBall, kBallRadius)});
}

/// The ground is seen from its front, and culled.
inline Surface backs() { return all_of({back_of(kSlab), back_of_ball()}); }

inline Camera camera_of(const Window& window, bool orthographic = false) {
  return look_at(
      orthographic ? camera_from_ortho_width(4, window, 1) : camera_from_fov(45, window, 1), kEye,
      kTarget, {0, 0, 1});
}

/// Writes P, N and albedo of what a camera sees of these surfaces, and returns the file's name.
inline std::string write_view(const std::filesystem::path& path, const Surface& shown,
                              const Camera& camera, const Window& window,
                              bool turn_normals = false) {
  Picture picture = take_picture(shown, camera, window);
  if (turn_normals)
    for (glm::vec3& n : picture.normal.pixels) n = -n;
  FramePart part = frame_of(picture);
  part.display = {0, 0, window.x0 + window.x1, window.y0 + window.y1};
  write_frame(path, part);
  return path;
}

}  // namespace ssdo::test
