// SPDX-License-Identifier: Apache-2.0
#include "estimators/bitmask/march_scene.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>
#include <utility>

#include "parallel/tiles.h"
#include "scene/normals/geometric_normal.h"
#include "scene/surfaces.h"

namespace ssdo {
namespace {

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

/// What a pixel shows, in the planes of MarchScene.
struct Cell {
  float depth = kNothing, ray_length = 1;  ///< length of the ray per unit of depth
  glm::vec2 slope{0};                      ///< of the ray
  glm::vec3 normal{kNothing};

  bool is_surface() const { return holds_solid(depth); }
};

/// What a solid holds in the planes of MarchLayer.
struct Span {
  float depth = kNothing, thickness = kNothing;
};

/// The cells of a raster.
class Cells {
 public:
  Cells(const Geometry& g, const MarchScene& scene)
      : g_(g),
        scene_(scene),
        endless_(scene.orthographic ? kInfiniteThickness : kInfiniteThicknessRatio),
        per_px_(1 / scene.fx, -1 / scene.fy) {}

  /// `normal` is that of the surface.
  Cell at(int x, int y, const glm::vec3& normal) const {
    Cell cell;
    const Surfel& s = g_.surfaces(x, y);
    if (!s.is_usable()) return cell;
    const glm::vec2 slope = cell.slope = ray_slope(scene_, x, y);
    if (!scene_.orthographic) cell.ray_length = std::sqrt(1 + glm::dot(slope, slope));
    cell.normal = normal;
    cell.depth = depth_on_ray(s, cell.normal, slope, cell.ray_length);
    return cell;
  }

  /// As MarchPlanes has it.
  glm::vec2 tilt(const Cell& cell) const {
    if (!cell.is_surface()) return glm::vec2(kNothing);
    const glm::vec3 ray(scene_.orthographic ? glm::vec2(0) : cell.slope, -1.0f);
    // A surface that turns away from the viewer is treated as seen edge-on.
    const float per_ray = 1 / std::min(glm::dot(cell.normal, ray), -1e-9f);
    return per_ray * glm::vec2(cell.normal) * per_px_;
  }

  Span span(const Cell& cell, const Solid& solid) const {
    if (!solid.exists()) return {};
    if (scene_.orthographic) {
      return {cell.depth + std::min(solid.distance, endless_), std::min(solid.thickness, endless_)};
    }
    const float per_length = 1 / (cell.depth * cell.ray_length);
    const float behind = std::min(solid.distance * per_length, endless_);
    return {cell.depth * (1 + behind),
            std::min(solid.thickness * per_length / (1 + behind), endless_)};
  }

 private:
  /// Depth at which the ray through a pixel's middle, which has this slope and length per unit of
  /// depth, meets the tangent plane of what the pixel shows.
  float depth_on_ray(const Surfel& s, const glm::vec3& normal, const glm::vec2& slope,
                     float length) const {
    const glm::vec3 position(s.position);
    const float depth = -position.z;
    const glm::vec3 ray(slope, scene_.orthographic ? 0.0f : -1.0f),
        on_ray = scene_.orthographic ? glm::vec3(slope, position.z) : depth * ray;
    const float per_depth = scene_.orthographic ? -normal.z : glm::dot(normal, ray);
    if (!(-per_depth > kLeastFacing * length)) return depth;
    const float moved = depth + glm::dot(normal, position - on_ray) / per_depth;
    // Where all rays are parallel, a depth may be next to 0 and gives no scale for a test.
    const bool credible =
        scene_.orthographic ? moved > 0 : moved > 0.5f * depth && moved < 2 * depth;
    return credible ? moved : depth;
  }

  const Geometry& g_;
  const MarchScene& scene_;
  const float endless_;
  const glm::vec2 per_px_;  ///< change of a ray's slope from a pixel to the next
};

}  // namespace

glm::vec2 ray_slope(const MarchScene& scene, int x, int y) {
  return {(float(x + scene.first_x) - scene.axis_x) / scene.fx,
          (scene.axis_y - float(y + scene.first_y)) / scene.fy};
}

glm::vec3 tangent_normal(const MarchScene& scene, int x, int y) {
  const std::ptrdiff_t i = scene.layout.index(x, y);
  const glm::vec2 tilt = unpack_bf16x2_exact(scene.tilt[i], scene.tilt_rest[i]),
                  aside = tilt * glm::vec2(-scene.fx, scene.fy),
                  slope = scene.orthographic ? glm::vec2(0) : ray_slope(scene, x, y);
  return glm::normalize(glm::vec3(aside, 1 + glm::dot(aside, slope)));
}

float reach_px(float f, bool orthographic, const glm::vec3& point, float radius) {
  constexpr float kMargin = 1.01f;  // a march puts surfaces onto the middles of their pixels
  if (orthographic) return kMargin * f * radius;
  const float depth = -point.z, r = radius;
  if (depth <= kMargin * r) return std::numeric_limits<float>::infinity();
  return kMargin * f * r * glm::length(point) / (depth * (depth - r));
}

float reach_px(const Geometry& g, float radius) {
  const auto f = float(std::max(g.camera.fx, g.camera.fy));
  float reach = 0;
  for (const Surfel& s : g.surfaces) {
    if (!s.is_surface()) continue;
    reach = std::max(reach, reach_px(f, g.camera.orthographic, s.position, radius));
  }
  return reach;
}

namespace {

/// Calls `visit(index, x, y, cell)` for the pixels of a geometry, and for the padding of the planes
/// of `scene`, with x outside of the geometry and an empty cell.
template <class Visit>
void for_each_cell(const Geometry& g, const MarchScene& scene, const Cells& cells,
                   const Visit& visit) {
  const Interleaving& layout = scene.layout;
  for_each_row(g.surfaces.height, [&](int y) {
    constexpr int kPad = Interleaving::kPad;
    // From left to right: eight walks over every eighth pixel would each fetch three rows of
    // surfels.
    std::vector<glm::vec3> normals(std::size_t(g.surfaces.width));
    find_geometric_normals(g.surfaces, y, g.camera.orthographic, normals);
    std::vector<Cell> cells_of_row;
    cells_of_row.reserve(normals.size());
    for (int x = 0; x < g.surfaces.width; ++x)
      cells_of_row.push_back(cells.at(x, y, normals[std::size_t(x)]));
    for (int column_phase = 0; column_phase < Interleaving::kPeriod; ++column_phase) {
      const std::ptrdiff_t row = layout.index(y, column_phase, 0);
      for (int column = -kPad; column < int(layout.stride()) - kPad; ++column) {
        const int x = column * Interleaving::kPeriod + column_phase - layout.phase();
        visit(row + column, x, y,
              x >= 0 && x < g.surfaces.width ? cells_of_row[std::size_t(x)] : Cell());
      }
    }
  });
}

}  // namespace

MarchScene make_march_scene(const Geometry& g, const Solids& solids, const Window& receivers,
                            const Geometry* receiving, float radius) {
  check_layers(solids);
  const Interleaving layout(g.surfaces.width, g.surfaces.height,
                            (g.window.x0 - g.display.x0) & (Interleaving::kPeriod - 1));
  const auto plane = [&] {
    InterleavedPlane values(layout);
    std::fill_n(values.data() + layout.size() - Interleaving::kPad, Interleaving::kPad, kNothing);
    return values;
  };
  // The planes that products still need at the end come first: the rest is then freed in one piece.
  std::vector<MarchLayer> layers;
  for (int k = 0; k < solids.layers(); ++k) layers.push_back({plane(), plane()});
  const Window frame = g.part_of.value_or(g.window);
  MarchScene scene{{std::move(layers), plane(), plane()},
                   layout,
                   {receivers.x0 - g.window.x0, receivers.y0 - g.window.y0,
                    receivers.x1 - g.window.x0, receivers.y1 - g.window.y0},
                   g.camera.orthographic,
                   float(g.camera.fx),
                   float(g.camera.fy),
                   float(g.camera.cx - g.display.x0 - 0.5),
                   float(g.camera.cy - g.display.y0 - 0.5),
                   g.window.x0 - g.display.x0,
                   g.window.y0 - g.display.y0,
                   frame.width(),
                   frame.height(),
                   g.window.y0 - frame.y0,
                   receiving ? receiving->surfaces : g.surfaces,
                   g.surfaces,
                   BorderLayout(layout),
                   {},
                   {},
                   {},
                   {},
                   {},
                   {},
                   {}};
  if (receivers.area() == 0) scene.receivers = scene.raster();
  const Cells cells(g, scene);
  for_each_cell(g, scene, cells, [&](std::ptrdiff_t i, int x, int y, const Cell& cell) {
    const glm::vec2 tilt = cells.tilt(cell);
    scene.tilt[i] = pack_bf16x2(tilt.x, tilt.y),
    scene.tilt_rest[i] = pack_bf16x2_rest(tilt.x, tilt.y);
    for (int k = 0; k < solids.layers(); ++k) {
      const Span span =
          cell.is_surface()
              ? cells.span(cell, solid_within(g, solids, k, g.surfaces.index(x, y), radius))
              : Span();
      MarchLayer& layer = scene.layers[std::size_t(k)];
      layer.depth[i] = span.depth, layer.thickness[i] = span.thickness;
    }
  });
  if (receiving) {
    scene.own_depth = plane(), scene.own_tilt = plane(), scene.own_tilt_rest = plane();
    const Cells own(*receiving, scene);
    for_each_cell(*receiving, scene, own, [&](std::ptrdiff_t i, int, int, const Cell& cell) {
      const glm::vec2 tilt = own.tilt(cell);
      scene.own_depth[i] = cell.depth;
      scene.own_tilt[i] = pack_bf16x2(tilt.x, tilt.y);
      scene.own_tilt_rest[i] = pack_bf16x2_rest(tilt.x, tilt.y);
    });
  }
  scene.border_depth =
      scene.border.gather([&](int x, int y) { return scene.depth()[layout.index(x, y)]; });
  for (int c = 0; c < 3; ++c) {
    scene.border_normal[c] =
        scene.border.gather([&](int x, int y) { return tangent_normal(scene, x, y)[c]; });
  }
  scene.border_thickness = scene.border.gather([&](int x, int y) {
    return std::min(solid_within(g, solids, 0, g.surfaces.index(x, y), radius).thickness,
                    kInfiniteThickness);
  });
  if (!solids.beyond.empty()) {
    scene.border_beyond = scene.border.gather(
        [&](int x, int y) { return std::min(solids.beyond.at(x, y), kInfiniteThickness); });
  }
  return scene;
}

}  // namespace ssdo
