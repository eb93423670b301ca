// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "scene/scene.h"

namespace ssdo::test {

/// Surfaces of one albedo in light from `environment`, infinitely thick.
inline Scene scene_of(Geometry geometry,
                      const Environment& environment = Environment::constant(glm::vec3(1)),
                      float albedo = 0) {
  Scene scene;
  scene.light = model_light(environment, geometry.world_to_camera);
  scene.senders.albedo =
      Plane<glm::vec3>(geometry.surfel.width, geometry.surfel.height, glm::vec3(albedo));
  scene.geometry = std::move(geometry);
  return scene;
}

}  // namespace ssdo::test
