// SPDX-License-Identifier: Apache-2.0
#include "color/compose.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <type_traits>

#include "math/light_range.h"

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

/// beauty - ambient (1 - ao), or ambient ao without a beauty. Occlusion says how much of the sky is
/// hidden, not of a lamp: what lamps give stays as rendered. Rendered layers are premultiplied.
Plane<glm::vec3> occlude_ambient(const Scene& scene, const GBuffer& gbuffer,
                                 const Plane<float>& ao) {
  const Plane<float> alpha = coverage(scene, gbuffer);
  Plane<glm::vec3> out(ao.width, ao.height);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (alpha[i] <= 0) continue;
    const glm::vec3 rest =
        gbuffer.beauty.empty() ? glm::vec3(0) : gbuffer.beauty[i] - gbuffer.ambient[i];
    out[i] = (rest + ao[i] * gbuffer.ambient[i]) / alpha[i];
  }
  return out;
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

Plane<glm::vec3> composite(const Scene& scene, const GBuffer& gbuffer, const Products& products) {
  if (!gbuffer.ambient.empty()) return occlude_ambient(scene, gbuffer, products.ao);
  Plane<glm::vec3> out = products.direct;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (!products.bounce.empty()) out[i] += products.bounce[i];
    out[i] = within_range(out[i] * scene.senders.albedo[i]);
  }
  return out;
}

std::vector<NamedPlane> product_channels(const std::string& name, const Scene& scene,
                                         const GBuffer& gbuffer, const Products& products) {
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
            return append(name + ".", in_input_space(plane, scene.geometry.normals_to_camera));
        }
        append(name + ".", plane);
      },
      products);
  if (wanted.in) return out;
  Plane<glm::vec3> color = composite(scene, gbuffer, products);
  Plane<float> alpha = coverage(scene, gbuffer);
  for (std::size_t i = 0; i < color.size(); ++i) color[i] *= alpha[i];
  append("", color);
  out.push_back({"A", std::move(alpha)});
  return out;
}

}  // namespace ssdo
