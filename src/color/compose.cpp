// SPDX-License-Identifier: Apache-2.0
//
// The composites. Rendered layers are premultiplied, and so is the result, so that edges whose
// alpha is between 0 and 1 need no division.
//
//   relight   alpha albedo (direct + bounce)
//   occlude   beauty - ambient (1 - S) - specular (1 - reflection)
//   add       beauty + alpha albedo (direct + bounce)
//
// S is the share of the environment's light that arrives. Light from everywhere alike is hidden by
// 1 - ao. Of other light, each channel has a share of its own, direct over the direct light without
// occluders: what hides a red light and not a green one throws a green shadow, where ao would make
// it brown (Ritschel, Grosch, Seidel, "Approximating Dynamic Global Illumination in Image Space",
// 2009). What lamps give stays as rendered: ambient is a part of the beauty.
//
// occlude and add keep the beauty and its alpha where there is no geometry.
#include "color/compose.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <type_traits>

#include "math/light_range.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

/// Channel `c` of a plane.
Plane<float> channel(const Plane<float>& values, int /*c*/) { return values; }
Plane<float> channel(const Plane<glm::vec3>& colors, int c) {
  Plane<float> out(colors.width, colors.height);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = colors[i][c];
  return out;
}

/// Directions from camera space into the space of the input's normals.
Plane<glm::vec3> in_input_space(Plane<glm::vec3> directions, const glm::mat3& normals_to_camera) {
  // The one is turned against the other, so that the transpose is the inverse.
  for (glm::vec3& d : directions.pixels) {
    const glm::vec3 seen = d;
    for (int c = 0; c < 3; ++c) d[c] = glm::dot(normals_to_camera[c], seen);
  }
  return directions;
}

/// albedo (direct + bounce).
glm::vec3 light_of(const Results& r, std::size_t i) {
  glm::vec3 light = r.products.direct[i];
  if (!r.products.bounce.empty()) light += r.products.bounce[i];
  return within_range(light * r.scene.senders.albedo[i]);
}

/// The share of the environment's light that arrives at a surface, by channel, 0 to 1. Methods that
/// look light up in another direction than the normal may find more than arrives without occluders;
/// occlusion brightens nothing. A channel without light has the share of all channels together, and
/// where there is no light at all, nothing is taken away.
glm::vec3 arriving_share(const Results& r, std::size_t i) {
  if (r.composition.share_is_ao) return glm::vec3(r.products.ao[i]);
  const glm::vec3 direct = r.products.direct[i],
                  open = r.scene.light.unoccluded(r.scene.geometry.surfel[i].normal);
  const auto share = [](float part, float whole, float otherwise) {
    return whole > 0 ? std::clamp(part / whole, 0.0f, 1.0f) : otherwise;
  };
  const float all = share(direct.x + direct.y + direct.z, open.x + open.y + open.z, 1);
  return {share(direct.x, open.x, all), share(direct.y, open.y, all), share(direct.z, open.z, all)};
}

/// What occlude and add change: the beauty, or the ambient layer alone where there is no beauty.
const Plane<glm::vec3>& rendered(const GBuffer& gbuffer) {
  return gbuffer.beauty.empty() ? gbuffer.ambient : gbuffer.beauty;
}

glm::vec3 occluded(const Results& r, std::size_t i) {
  const glm::vec3 beauty = rendered(r.gbuffer)[i];
  glm::vec3 hidden = r.gbuffer.ambient[i] * (glm::vec3(1) - arriving_share(r, i));
  if (!r.gbuffer.specular.empty()) hidden += r.gbuffer.specular[i] * (1 - r.products.reflection[i]);
  // No light is negative, unless the render has it so, even where the layers do not add up to it.
  return glm::max(within_range(beauty - hidden), glm::min(beauty, glm::vec3(0)));
}

}  // namespace

Plane<float> coverage(const Scene& scene, const GBuffer& gbuffer) {
  const Geometry& geometry = scene.geometry;
  Plane<float> alpha(geometry.surfel.width, geometry.surfel.height, 0.0f);
  for (std::size_t i = 0; i < alpha.size(); ++i) {
    if (!geometry.is_surface(i)) continue;
    const float a = gbuffer.alpha.empty() ? 1.0f : gbuffer.alpha[i];
    alpha[i] = std::isfinite(a) ? std::clamp(a, 0.0f, 1.0f) : 1.0f;
  }
  return alpha;
}

Composite composite(const Results& r) {
  const Compose compose = r.composition.compose;
  const Geometry& geometry = r.scene.geometry;
  Composite out{Plane<glm::vec3>::like(geometry.surfel), coverage(r.scene, r.gbuffer)};
  for_each_row(out.color.height, [&](int y) {
    for (int x = 0; x < out.color.width; ++x) {
      const std::size_t i = out.color.index(x, y);
      glm::vec3& color = out.color[i];
      if (compose == Compose::relight) {
        color = out.alpha[i] * light_of(r, i);
        continue;
      }
      color = rendered(r.gbuffer)[i];
      if (!geometry.is_surface(i) && !r.gbuffer.alpha.empty() && std::isfinite(r.gbuffer.alpha[i]))
        out.alpha[i] = r.gbuffer.alpha[i];
      if (!geometry.surfel[i].is_usable()) continue;
      color = compose == Compose::occlude ? occluded(r, i)
                                          : within_range(color + out.alpha[i] * light_of(r, i));
    }
  });
  return out;
}

std::vector<NamedPlane> product_channels(const std::string& name, const Results& results) {
  const Product& wanted = find_product(name);
  std::vector<NamedPlane> out;
  const auto append = [&](const std::string& prefix, const auto& plane) {
    for (const char letter : wanted.channels.substr(0, sizeof(plane[0]) / sizeof(float)))
      out.push_back({prefix + letter, channel(plane, int(out.size()))});
  };
  for_each_plane(
      [&](const Product& product, const auto& plane) {
        if (&product != &wanted) return;
        if constexpr (std::is_same_v<decltype(plane), const Plane<glm::vec3>&>) {
          if (product.kind == ProductKind::direction)
            return append(name + ".",
                          in_input_space(plane, results.scene.geometry.normals_to_camera));
        }
        append(name + ".", plane);
      },
      results.products);
  if (wanted.in) return out;
  Composite composed = composite(results);
  append("", composed.color);
  out.push_back({"A", std::move(composed.alpha)});
  return out;
}

}  // namespace ssdo
