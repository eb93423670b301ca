// SPDX-License-Identifier: Apache-2.0
//
// Compiled once for every instruction set.
#include "estimators/specular/specular.h"

#include <algorithm>
#include <vector>

#include "parallel/tiles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "estimators/specular/specular.cpp"
#include <hwy/foreach_target.h>

#include "estimators/specular/mirrored_light-inl.h"
#include "scene/surfaces-inl.h"

HWY_BEFORE_NAMESPACE();
namespace ssdo::HWY_NAMESPACE {

void specular_of_frame(const Scene& scene, Products& products) {
  const MirrorModel& model = *products.visibility.mirror;
  const Light& light = scene.light;
  const bool orthographic = scene.geometry.camera.orthographic;
  std::vector<FacetPoint> points;
  for (int k = 0; k < kSkyPoints; ++k) points.emplace_back(sobol_point(std::uint32_t(k), 0));
  std::vector<MirroredSource> sources;
  for (const auto& source : light.sources) sources.emplace_back(*source);
  const Surfaces& surfaces = scene.geometry.surfaces;
  for_each_row(surfaces.height, [&](int y) HWY_ATTR {
    for (int x = 0; x < surfaces.width; x += kLanes) {
      const std::size_t i = surfaces.index(x, y);
      const int count = std::min(kLanes, surfaces.width - x);
      const Surfels s = surfels_at(surfaces, x, y);
      if (!any(s.surface)) {
        store_first(count, set(glm::vec3(0)), &products.specular[i]);
        continue;
      }
      alignas(64) float roughness[kLanes] = {};
      glm::vec3 colors[kLanes] = {};
      for (int k = 0; k < count; ++k) {
        roughness[k] = model.roughness_at(scene, i + std::size_t(k));
        colors[k] = model.f0_at(scene, i + std::size_t(k));
      }
      const V3 facing_us = set(glm::vec3(0, 0, 1)),
               normal = if_then_else(s.surface, s.normal, facing_us),
               position = if_then_else(s.surface, s.position, set(glm::vec3(0, 0, -1)));
      const V3 viewer = orthographic ? facing_us : normalise(-position);
      const V3 f0 = load(colors);
      const MirrorFrame frame(normal, viewer, load(roughness));
      const V3 even = reflectance(model.reflectances, frame.cosine, load(roughness), f0);
      const V3 sky = light.sky.is_constant() ? set(light.sky.constant_radiance())
                                             : mirrored_sky(model, points, frame, f0);
      const V3 share = saturate(load_first(count, &products.visibility.mirrored_sky[i])),
               mirrored = load_first(count, &products.specular[i]);
      V3 sum = even * (sky * share + mirrored);
      for (std::size_t k = 0; k < sources.size(); ++k) {
        const V arrives = saturate(load_first(count, &products.visibility.sources[k][i])) *
                          link_weight(*light.sources[k], i, count);
        sum = mul_add(mirrored_source(sources[k], position, frame, f0), arrives, sum);
      }
      store_first(count, if_then_else_zero(s.surface, within_range(sum)), &products.specular[i]);
    }
  });
}

}  // namespace ssdo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace ssdo {

HWY_EXPORT(specular_of_frame);

void add_specular(Products& products, const Scene& scene) {
  if (!products.visibility.mirror) return;
  HWY_DYNAMIC_DISPATCH(specular_of_frame)(scene, products);
}

}  // namespace ssdo
#endif
