// SPDX-License-Identifier: Apache-2.0
#include "estimators/march_scene.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "parallel/tiles.h"

namespace ssdo {
namespace {

constexpr int kPeriod = Interleaving::kPeriod;
constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

/// In front of the viewer, and nothing in it that arithmetic would carry into its neighbours.
bool is_usable(const Surfel& s) {
  return s.position.w != 0 && s.position.z < -1e-15f &&
         std::isfinite(glm::dot(s.position, s.position)) &&
         std::isfinite(glm::dot(s.normal, s.normal));
}

/// Least share of the normal along a ray that meets its plane: a plane tilted by 89.9 degrees has
/// 0.0017.
constexpr float kLeastFacing = 1e-3f;

/// Depth at which a ray with the direction (slope_x, slope_y, -1), or along the axis from there,
/// meets the tangent plane of a surfel that lies near it.
float depth_on_ray(const Surfel& s, float slope_x, float slope_y, bool orthographic) {
  const glm::vec3 position(s.position), normal(s.normal);
  const float depth = -position.z;
  const glm::vec3 ray(slope_x, slope_y, orthographic ? 0.0f : -1.0f),
      on_ray = orthographic ? glm::vec3(slope_x, slope_y, position.z) : depth * ray;
  const float facing = orthographic ? normal.z : -glm::dot(normal, ray) / glm::length(ray);
  if (!(facing > kLeastFacing)) return depth;
  const float per_depth = orthographic ? -normal.z : glm::dot(normal, ray);
  const float moved = depth + glm::dot(normal, position - on_ray) / per_depth;
  return moved > 0.5f * depth && moved < 2 * depth ? moved : depth;
}

}  // namespace

MarchScene make_march_scene(const Geometry& g, const HiddenGeometry* hidden) {
  const bool orthographic = g.camera.orthographic;
  const Interleaving layout(g.surfel.width, g.surfel.height,
                            (g.window.x0 - g.display.x0) & (kPeriod - 1));
  const auto plane = [&] { return InterleavedPlane(layout); };
  MarchScene scene{layout,
                   orthographic,
                   float(g.camera.fx),
                   float(g.camera.fy),
                   float(g.camera.cx - g.window.x0 - 0.5),
                   float(g.camera.cy - g.window.y0 - 0.5),
                   plane(),
                   plane(),
                   plane(),
                   plane(),
                   plane(),
                   plane(),
                   plane(),
                   plane(),
                   BorderLayout(layout),
                   {},
                   {},
                   {}};
  const float endless = orthographic ? kEndlessLength : kEndlessShare;
  for_each_row(g.surfel.height, [&](int y) {
    for (InterleavedPlane* p :
         {&scene.depth, &scene.thickness, &scene.behind, &scene.behind_thickness, &scene.nx,
          &scene.ny, &scene.nz, &scene.rounding}) {
      p->fill_row(layout, y, kNothing);
    }
    const float slope_y = (scene.axis_y - float(y)) / scene.fy;
    for (int x = 0; x < g.surfel.width; ++x) {
      const std::size_t from = g.surfel.index(x, y);
      const Surfel& s = g.surfel[from];
      if (!is_usable(s)) continue;
      const std::ptrdiff_t i = layout.index(x, y);
      const float slope_x = (float(x) - scene.axis_x) / scene.fx;
      const float depth = depth_on_ray(s, slope_x, slope_y, orthographic);
      scene.depth[i] = depth;
      scene.nx[i] = s.normal.x, scene.ny[i] = s.normal.y, scene.nz[i] = s.normal.z;
      scene.rounding[i] = s.normal.w;
      scene.thickness[i] = endless;
      if (!hidden) continue;
      const float distance =
          orthographic ? 1.0f : depth * std::sqrt(1 + slope_x * slope_x + slope_y * slope_y);
      scene.thickness[i] = std::min(hidden->thickness[from] / distance, endless);
      if (hidden->behind.empty() || hidden->behind_source[from] < 0) continue;
      const float behind = std::min(hidden->behind[from] / distance, endless);
      scene.behind[i] = orthographic ? depth + behind : depth * (1 + behind);
      const float distance_behind = orthographic ? 1.0f : distance * (1 + behind);
      scene.behind_thickness[i] = std::min(
          hidden->thickness[std::size_t(hidden->behind_source[from])] / distance_behind, endless);
    }
  });
  scene.border_depth =
      scene.border.gather([&](int x, int y) { return scene.depth[layout.index(x, y)]; });
  for (int c = 0; c < 3; ++c) {
    scene.border_normal[c] =
        scene.border.gather([&](int x, int y) { return g.surfel(x, y).normal[c]; });
  }
  scene.border_thickness = scene.border.gather([&](int x, int y) {
    return hidden ? std::min(hidden->thickness(x, y), kEndlessLength) : kEndlessLength;
  });
  return scene;
}

}  // namespace ssdo
