// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <string>

#include "estimators/bitmask/request.h"
#include "estimators/registry.h"
#include "estimators/specular/mirror_model.h"
#include "estimators/specular/specular.h"
#include "support/analytic_scene.h"
#include "support/scene_of.h"

namespace ssdo::test {

inline constexpr Window kWindow{0, 0, 96, 64};
inline constexpr double kMirror = 1e6;  ///< an index of refraction: F0 is 1

inline Request request_of(const Method& method, double roughness, double ior = kMirror) {
  Request request{.products = {.direct = true, .specular = true},
                  .radius = kNoLimit,
                  .parameters = resolve_parameters(method, {}),
                  .slices = 4,
                  .steps = 64,
                  .extend_offscreen = false};
  request.parameters["roughness"] = roughness, request.parameters["ior"] = ior;
  return request;
}

/// The product without a filter.
inline Plane<glm::vec3> specular_of(const std::string& method, const Scene& scene, double roughness,
                                    double ior = kMirror) {
  const Method& by = find_method(method);
  Products found = by.estimate(scene, request_of(by, roughness, ior), {});
  add_specular(found, scene);
  return found.specular;
}

/// What is mirrored of light with nothing in its way.
inline Plane<glm::vec3> unoccluded(const Scene& scene, double roughness, double ior = kMirror) {
  Products all;
  all.visibility.mirror = std::make_shared<const MirrorModel>(
      scene, request_of(find_method("bitmask"), roughness, ior));
  const Surfaces& surfaces = scene.geometry.surfaces;
  all.specular = Plane<glm::vec3>(surfaces.width, surfaces.height);
  all.visibility.mirrored_sky = all.specular;
  std::fill(all.visibility.mirrored_sky.pixels.begin(), all.visibility.mirrored_sky.pixels.end(),
            glm::vec3(1));
  all.visibility.sources.assign(scene.light.sources.size(),
                                Plane<float>(kWindow.width(), kWindow.height(), 1.0f));
  add_specular(all, scene);
  return all.specular;
}

inline Geometry floor_seen_at(double tilt_degrees) {
  return geometry_of(plane({}, {0, 0, 1}), tilted(camera_from_fov(30, kWindow, 1), tilt_degrees),
                     kWindow);
}

inline Environment painted(const std::function<glm::vec3(const glm::vec3&)>& radiance,
                           int width = 256) {
  const auto map = std::make_shared<Plane<glm::vec3>>(width, width / 2);
  const Environment directions(map, {.up = UpAxis::z});
  for (int y = 0; y < map->height; ++y)
    for (int x = 0; x < map->width; ++x) (*map)(x, y) = radiance(directions.texel_direction(x, y));
  return {map, {.up = UpAxis::z}};
}

}  // namespace ssdo::test
