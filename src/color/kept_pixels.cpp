// SPDX-License-Identifier: Apache-2.0
#include "color/kept_pixels.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "color/light_colors.h"
#include "parallel/tiles.h"
#include "scene/light/light_group.h"

namespace ssdo {
namespace {

/// Moves the values of a plane towards `open(pixel)` where pixels are kept.
template <class T, class Open>
void mix(Plane<T>& plane, const Plane<float>& kept, const Open& open) {
  if (plane.empty()) return;
  for_each_row(plane.height, [&](int y) {
    for (std::size_t i = plane.index(0, y); i < plane.index(0, y + 1); ++i)
      if (kept[i] > 0) plane[i] = glm::mix(plane[i], open(i), kept[i]);
  });
}

void open_light(Plane<glm::vec3>& direct, const Plane<float>& kept, const Scene& scene,
                const Light& light) {
  if (direct.empty()) return;
  const Plane<glm::vec3> all = unoccluded_light(scene, light);
  mix(direct, kept, [&](std::size_t i) { return all[i]; });
}

void open_bent(Plane<glm::vec3>& bent, const Plane<float>& kept, const Geometry& geometry) {
  mix(bent, kept, [&](std::size_t i) {
    return geometry.is_surface(i) ? geometry.surfaces[i].normal : glm::vec3(0);
  });
  for (std::size_t i = 0; i < bent.size(); ++i) {
    const float length = glm::length(bent[i]);
    if (kept[i] > 0 && length > 0) bent[i] /= length;
  }
}

}  // namespace

std::optional<Products> open_kept_pixels(const Products& found, const Scene& scene,
                                         const GBuffer& gbuffer) {
  const Plane<float>& kept = gbuffer.masks.kept;
  if (kept.empty()) return std::nullopt;
  Products out = found;
  out.visibility = {};
  open_light(out.direct, kept, scene, scene.light);
  open_bent(out.bent, kept, scene.geometry);
  mix(out.lit, kept, [&](std::size_t i) { return out.lit_without[i]; });
  const std::vector<LightGroup> lights = light_groups_of(scene.light);
  for (std::size_t k = 0; k < out.lights.size() && k < lights.size(); ++k)
    open_light(out.lights[k].direct, kept, scene, lights[k].light);
  for_each_plane(
      [&](const Product& product, auto& plane) {
        using Value = std::decay_t<decltype(plane[0])>;
        if (product.name == "direct" || product.name == "bent") return;
        mix(plane, kept, [&](std::size_t) { return Value(product.background); });
      },
      out);
  return out;
}

}  // namespace ssdo
