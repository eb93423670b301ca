// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/march_scene.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>

#include "parallel/tiles.h"
#include "scene/usable.h"

namespace ssdo {
namespace {

constexpr int kPeriod = Interleaving::kPeriod;
constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

/// Least share of the normal along a ray that meets its plane: a plane tilted by 89.9 degrees has
/// 0.0017.
constexpr float kLeastFacing = 1e-3f;

/// What a pixel holds in the planes of MarchScene.
struct Cell {
  float depth = kNothing, thickness = kNothing, behind = kNothing, behind_thickness = kNothing;
  glm::vec4 normal{kNothing};  ///< and the rounding
};

/// The cells of a frame.
class Cells {
 public:
  Cells(const Geometry& g, const HiddenGeometry& hidden, const MarchScene& scene)
      : g_(g),
        hidden_(hidden),
        scene_(scene),
        endless_(scene.orthographic ? kEndlessLength : kEndlessShare) {}

  Cell at(int x, int y) const {
    Cell cell;
    const std::size_t from = g_.surfel.index(x, y);
    const Surfel& s = g_.surfel[from];
    if (!is_usable(s)) return cell;
    const glm::vec2 slope((float(x + scene_.first_x) - scene_.axis_x) / scene_.fx,
                          (scene_.axis_y - float(y + scene_.first_y)) / scene_.fy);
    const float length = scene_.orthographic ? 1.0f : std::sqrt(1 + glm::dot(slope, slope));
    cell.depth = depth_on_ray(s, slope, length);
    cell.normal = s.normal;
    cell.thickness = endless_;
    if (hidden_.thickness.empty()) return cell;
    const float per_distance = scene_.orthographic ? 1.0f : 1 / (cell.depth * length);
    cell.thickness = std::min(hidden_.thickness[from] * per_distance, endless_);
    if (hidden_.behind.empty() || hidden_.behind_source[from] < 0) return cell;
    const float behind = std::min(hidden_.behind[from] * per_distance, endless_);
    const float thickness =
        hidden_.thickness[std::size_t(hidden_.behind_source[from])] * per_distance;
    cell.behind = scene_.orthographic ? cell.depth + behind : cell.depth * (1 + behind);
    cell.behind_thickness =
        std::min(scene_.orthographic ? thickness : thickness / (1 + behind), endless_);
    return cell;
  }

 private:
  /// Depth at which the ray through a pixel's middle, which has this slope and length per unit of
  /// depth, meets the tangent plane of what the pixel shows.
  float depth_on_ray(const Surfel& s, const glm::vec2& slope, float length) const {
    const glm::vec3 position(s.position), normal(s.normal);
    const float depth = -position.z;
    const glm::vec3 ray(slope, scene_.orthographic ? 0.0f : -1.0f),
        on_ray = scene_.orthographic ? glm::vec3(slope, position.z) : depth * ray;
    const float per_depth = scene_.orthographic ? -normal.z : glm::dot(normal, ray);
    if (!(-per_depth > kLeastFacing * length)) return depth;
    const float moved = depth + glm::dot(normal, position - on_ray) / per_depth;
    // A depth has no scale to doubt it by where all rays are parallel: it may be next to nothing.
    const bool credible =
        scene_.orthographic ? moved > 0 : moved > 0.5f * depth && moved < 2 * depth;
    return credible ? moved : depth;
  }

  const Geometry& g_;
  const HiddenGeometry& hidden_;
  const MarchScene& scene_;
  const float endless_;
};

}  // namespace

MarchScene make_march_scene(const Geometry& g, const HiddenGeometry& hidden) {
  const bool orthographic = g.camera.orthographic;
  const Interleaving layout(g.surfel.width, g.surfel.height,
                            (g.window.x0 - g.display.x0) & (kPeriod - 1));
  const auto plane = [&] { return InterleavedPlane(layout); };
  MarchScene scene{layout,
                   orthographic,
                   float(g.camera.fx),
                   float(g.camera.fy),
                   float(g.camera.cx - g.display.x0 - 0.5),
                   float(g.camera.cy - g.display.y0 - 0.5),
                   g.window.x0 - g.display.x0,
                   g.window.y0 - g.display.y0,
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
  const Cells cells(g, hidden, scene);
  for_each_row(g.surfel.height, [&](int y) {
    constexpr int kPad = Interleaving::kPad;
    for (int comb = 0; comb < kPeriod; ++comb) {
      const std::ptrdiff_t row = layout.index(y, comb, 0);
      for (int column = -kPad; column < int(layout.stride()) - kPad; ++column) {
        const int x = column * kPeriod + comb - layout.phase();
        const Cell cell = x >= 0 && x < g.surfel.width ? cells.at(x, y) : Cell();
        const std::ptrdiff_t i = row + column;
        scene.depth[i] = cell.depth, scene.thickness[i] = cell.thickness;
        scene.behind[i] = cell.behind, scene.behind_thickness[i] = cell.behind_thickness;
        scene.nx[i] = cell.normal.x, scene.ny[i] = cell.normal.y, scene.nz[i] = cell.normal.z;
        scene.rounding[i] = cell.normal.w;
      }
    }
  });
  scene.border_depth =
      scene.border.gather([&](int x, int y) { return scene.depth[layout.index(x, y)]; });
  for (int c = 0; c < 3; ++c) {
    scene.border_normal[c] =
        scene.border.gather([&](int x, int y) { return g.surfel(x, y).normal[c]; });
  }
  scene.border_thickness = scene.border.gather([&](int x, int y) {
    return hidden.thickness.empty() ? kEndlessLength
                                    : std::min(hidden.thickness(x, y), kEndlessLength);
  });
  return scene;
}

}  // namespace ssdo
