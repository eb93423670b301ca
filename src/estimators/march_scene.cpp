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
  return s.position.z < -1e-15f && std::isfinite(glm::dot(s.position, s.position)) &&
         std::isfinite(glm::dot(s.normal, s.normal));
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
                   plane(),
                   plane(),
                   plane(),
                   plane(),
                   plane(),
                   plane(),
                   plane(),
                   plane(),
                   plane(),
                   plane(),
                   {},
                   {},
                   {}};
  const float endless = orthographic ? kEndlessLength : kEndlessShare;
  for_each_row(g.surfel.height, [&](int y) {
    for (InterleavedPlane* p :
         {&scene.x, &scene.y, &scene.z, &scene.nx, &scene.ny, &scene.nz, &scene.rounding,
          &scene.thickness, &scene.behind, &scene.behind_thickness}) {
      p->fill_row(layout, y, kNothing);
    }
    for (int x = 0; x < g.surfel.width; ++x) {
      const std::size_t from = g.surfel.index(x, y);
      const Surfel& s = g.surfel[from];
      if (!g.is_surface(from) || !is_usable(s)) continue;
      const std::ptrdiff_t i = layout.index(x, y);
      scene.x[i] = s.position.x, scene.y[i] = s.position.y, scene.z[i] = s.position.z;
      scene.nx[i] = s.normal.x, scene.ny[i] = s.normal.y, scene.nz[i] = s.normal.z;
      scene.rounding[i] = s.normal.w;
      scene.thickness[i] = endless;
      if (!hidden) continue;
      const float distance = orthographic ? 1.0f : glm::length(glm::vec3(s.position));
      scene.thickness[i] = std::min(hidden->thickness[from] / distance, endless);
      if (hidden->behind.empty() || hidden->behind_source[from] < 0) continue;
      scene.behind[i] = std::min(hidden->behind[from] / distance, endless);
      const float distance_behind = orthographic ? 1.0f : distance * (1 + scene.behind[i]);
      scene.behind_thickness[i] = std::min(
          hidden->thickness[std::size_t(hidden->behind_source[from])] / distance_behind, endless);
    }
  });
  for (int c = 0; c < 3; ++c) {
    const auto of_surfaces = [&](const glm::vec4 Surfel::*member) {
      return border_values(g.surfel.width, g.surfel.height, [&](int x, int y) {
        const Surfel& s = g.surfel(x, y);
        return s.position.w == 0 ? kNothing : (s.*member)[c];
      });
    };
    scene.border_position[c] = of_surfaces(&Surfel::position);
    scene.border_normal[c] = of_surfaces(&Surfel::normal);
  }
  scene.border_thickness = border_values(g.surfel.width, g.surfel.height, [&](int x, int y) {
    return hidden ? std::min(hidden->thickness(x, y), kEndlessLength) : kEndlessLength;
  });
  return scene;
}

}  // namespace ssdo
