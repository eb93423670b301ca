// SPDX-License-Identifier: Apache-2.0
#include "scene/solids/solids.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "math/infinity.h"
#include "math/pixel_grid.h"
#include "math/whole_division.h"
#include "parallel/planes.h"
#include "parallel/tiles.h"
#include "scene/normals/normals.h"
#include "scene/solids/shown_depth.h"

namespace ssdo {
namespace {

/// A pixel and the overview pixel that stands for it show the same object where their depths differ
/// by less than this share.
constexpr float kSameDepth = 0.1f;

}  // namespace

SolidLayer::SolidLayer(int width, int height, Provenance of_all)
    : provenance(filled(width, height, of_all)),
      distance(filled(width, height, kInfinity)),
      thickness(filled(width, height, kInfinity)),
      sender(filled(width, height, -1)) {}

Solid solid_within(const Geometry& geometry, const Solids& solids, int layer, std::size_t pixel,
                   float radius) {
  Solid solid = solids.at(layer, pixel);
  if (solid.thickness > radius && solids.depth_is_guessed(layer, pixel))
    solid.thickness = std::min(solid.thickness, std::max(radius, least_depth(geometry, pixel)));
  return solid;
}

float depth_in_overview(const SolidsOfOverview& overview, const Geometry& geometry, int x, int y) {
  const Geometry& small = overview.geometry;
  const auto block = [](int pixel, int first, int first_small, int size) {
    return std::clamp(floor_divide(pixel - first, kOverviewStride) - first_small, 0, size - 1);
  };
  const Window &window = geometry.window, &display = geometry.display;
  const int column = block(window.x0 + x, display.x0, small.window.x0, small.surfaces.width),
            row = block(window.y0 + y, display.y0, small.window.y0, small.surfaces.height);
  const Surfel &here = geometry.surfaces(x, y), &there = small.surfaces(column, row);
  const bool same = there.is_surface() && std::abs(here.position.z - there.position.z) <=
                                              kSameDepth * std::abs(here.position.z);
  return same ? overview.thickness(column, row) : kInfinity;
}

bool may_be_thin(const Solids& solids) {
  return std::ranges::any_of(solids.end.pixels,
                             [](Provenance end) { return end != Provenance::guessed; });
}

void check_layers(const Solids& solids) {
  if (solids.layers() > kMostLayers)
    throw std::logic_error("more layers of solids than kMostLayers of scene/solids/solids.h");
}

void Solids::separate_thicknesses() {
  for (std::size_t k = 0; k < behind.size(); ++k) {
    SolidLayer& layer = behind[k];
    if (!layer.thickness.empty()) continue;
    auto own = Plane<float>::like(layer.sender);
    for_each_row(own.height, [&](int y) {
      for (std::size_t i = own.index(0, y); i < own.index(0, y + 1); ++i)
        own[i] = thickness_seen(layer.sender[i]);
    });
    layer.thickness = std::move(own);
  }
}

glm::vec3 point_behind(const Geometry& geometry, std::size_t pixel, float distance) {
  const glm::vec3 p(geometry.surfaces[pixel].position);
  return p - distance * direction_to_viewer(p, geometry.camera.orthographic);
}

glm::vec3 normal_of_solid(const Geometry& geometry, const Solids& solids, int layer,
                          std::size_t pixel) {
  const int sender = solids.at(layer, pixel).sender;
  if (sender >= 0) return geometry.surfaces[std::size_t(sender)].normal;
  const Plane<glm::vec3>& normal = solids.behind[std::size_t(layer - 1)].normal;
  if (!normal.empty()) return normal[pixel];
  return direction_to_viewer(geometry.surfaces[pixel].position, geometry.camera.orthographic);
}

Solids constant_thickness(const Geometry& geometry, float thickness) {
  const int w = geometry.surfaces.width, h = geometry.surfaces.height;
  return {Plane<float>(w, h, thickness), Plane<Provenance>(w, h, Provenance::given), {}, {}};
}

}  // namespace ssdo
