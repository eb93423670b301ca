// SPDX-License-Identifier: Apache-2.0
//
// A pixel that shows several surfaces in part sends
//
//   F[a rho E] / pi
//
// with the coverage a, the albedo rho and the irradiance E of each, and the mean F under the pixel
// filter. Renderers write albedo as F[a rho], so that the light which belongs to it is the mean
// F[a rho E] / F[a rho], channel by channel; light passes that were divided by colour are the same.
#include "color/downsample.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "io/exr/pixel_filter.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

/// Added to albedo in weights, so that black surfaces have light where there are no others.
constexpr float kBlack = 1e-6f;

glm::vec3 divided(const glm::vec3& sum, const glm::vec3& weight, float otherwise) {
  glm::vec3 mean(otherwise);
  for (int c = 0; c < 3; ++c) {
    if (weight[c] > 0) mean[c] = sum[c] / weight[c];
  }
  return mean;
}

float divided(float sum, float weight, float otherwise) {
  return weight > 0 ? sum / weight : otherwise;
}

/// The mean of `values`, with `background` where no pixel has weight.
template <class T>
Plane<T> weighted_mean(const Plane<T>& values, const Plane<T>& weights, float background,
                       const GBuffer& gbuffer) {
  auto weighted = Plane<T>::like(values);
  for_each_row(values.height, [&](int y) {
    for (int x = 0; x < values.width; ++x) weighted(x, y) = weights(x, y) * values(x, y);
  });
  Plane<T> mean = at_output_size(std::move(weighted), gbuffer);
  const Plane<T> total = at_output_size(weights, gbuffer);
  for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = divided(mean[i], total[i], background);
  return mean;
}

Plane<glm::vec3> as_colors(const Plane<float>& values) {
  auto colors = Plane<glm::vec3>::like(values);
  for (std::size_t i = 0; i < values.size(); ++i) colors[i] = glm::vec3(values[i]);
  return colors;
}

}  // namespace

template <class T>
Plane<T> at_output_size(Plane<T> values, const GBuffer& gbuffer) {
  if (gbuffer.downsampling.is_identity()) return values;
  return filter_pixels(values, gbuffer.window, gbuffer.downsampling);
}
template Plane<float> at_output_size(Plane<float>, const GBuffer&);
template Plane<glm::vec3> at_output_size(Plane<glm::vec3>, const GBuffer&);

Plane<float> coverage(const Scene& scene, const GBuffer& gbuffer) {
  const Geometry& geometry = scene.geometry;
  auto alpha = Plane<float>::like(geometry.surfaces);
  for_each_row(alpha.height, [&](int y) {
    for (std::size_t i = alpha.index(0, y); i < alpha.index(0, y + 1); ++i) {
      const float a = gbuffer.alpha.empty() ? 1.0f : gbuffer.alpha[i];
      alpha[i] = !geometry.is_surface(i) ? 0 : std::isfinite(a) ? std::clamp(a, 0.0f, 1.0f) : 1.0f;
    }
  });
  return alpha;
}

Plane<float> weights_by_coverage(const Results& r) {
  Plane<float> weights = coverage(r.scene, r.gbuffer);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (!r.scene.geometry.surfaces[i].is_usable())
      weights[i] = 0;
    else if (r.gbuffer.downsampling.is_identity())
      weights[i] = 1;
  }
  return weights;
}

Plane<glm::vec3> weights_by_albedo(const Results& r) {
  Plane<glm::vec3> weights = as_colors(weights_by_coverage(r));
  const Plane<HalfColor>& albedo = r.scene.senders.albedo;
  if (r.gbuffer.downsampling.is_identity() || albedo.empty()) return weights;
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] *= glm::vec3(albedo[i]) + kBlack;
  return weights;
}

Plane<float> product_at_output_size(const Product& product, const Plane<float>& values,
                                    const Results& r) {
  if (r.gbuffer.downsampling.is_identity()) return values;
  return weighted_mean(values, weights_by_coverage(r), product.background, r.gbuffer);
}

Plane<glm::vec3> product_at_output_size(const Product& product, const Plane<glm::vec3>& values,
                                        const Results& r) {
  if (r.gbuffer.downsampling.is_identity()) return values;
  // What is mirrored is not multiplied by albedo.
  const bool is_light = product.kind == ProductKind::light && product.in != &ProductSet::specular;
  Plane<glm::vec3> mean =
      weighted_mean(values, is_light ? weights_by_albedo(r) : as_colors(weights_by_coverage(r)),
                    product.background, r.gbuffer);
  if (product.kind != ProductKind::direction) return mean;
  for (glm::vec3& direction : mean.pixels) {
    const float length = glm::length(direction);
    direction = length > 0 ? direction / length : glm::vec3(0);
  }
  return mean;
}

}  // namespace ssdo
