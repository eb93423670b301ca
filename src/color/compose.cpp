// SPDX-License-Identifier: Apache-2.0
#include "color/compose.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "math/light_range.h"

namespace ssdo {
namespace {

void append_color(std::vector<NamedPlane>& out, const std::string& prefix,
                  const Plane<glm::vec3>& colors) {
  for (int c = 0; c < 3; ++c) {
    NamedPlane named{prefix + "RGB"[c], Plane<float>(colors.width, colors.height)};
    for (std::size_t i = 0; i < colors.size(); ++i) named.pixels[i] = colors[i][c];
    out.push_back(std::move(named));
  }
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

std::vector<NamedPlane> product_channels(const std::string& product, const Scene& scene,
                                         const GBuffer& gbuffer, const Products& products) {
  std::vector<NamedPlane> out;
  if (product == "ao") {
    out.push_back({"ao.Y", products.ao});
  } else if (product == "reflection") {
    out.push_back({"reflection.Y", products.reflection});
  } else if (product == "error") {
    out.push_back({"error.Y", products.error});
  } else if (product == "bent") {
    for (int c = 0; c < 3; ++c) {
      NamedPlane named{std::string("bent.") + "XYZ"[c],
                       Plane<float>(products.bent.width, products.bent.height)};
      // The space of the input's normals is turned against camera space, so its transpose is its
      // inverse.
      const glm::vec3 axis = scene.geometry.normals_to_camera[c];
      for (std::size_t i = 0; i < named.pixels.size(); ++i)
        named.pixels[i] = glm::dot(axis, products.bent[i]);
      out.push_back(std::move(named));
    }
  } else if (product == "direct") {
    append_color(out, "direct.", products.direct);
  } else if (product == "bounce") {
    append_color(out, "bounce.", products.bounce);
  } else {
    Plane<glm::vec3> color = composite(scene, gbuffer, products);
    Plane<float> alpha = coverage(scene, gbuffer);
    for (std::size_t i = 0; i < color.size(); ++i) color[i] *= alpha[i];
    append_color(out, "", color);
    out.push_back({"A", std::move(alpha)});
  }
  return out;
}

}  // namespace ssdo
