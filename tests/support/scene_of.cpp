// SPDX-License-Identifier: Apache-2.0
#include "support/scene_of.h"

#include <utility>

namespace ssdo::test {

Scene scene_of(Geometry geometry, const Environment& environment, float albedo) {
  Scene scene;
  scene.light = model_light(environment, geometry.world_to_camera);
  scene.senders.albedo =
      Plane<HalfColor>(geometry.surfaces.width, geometry.surfaces.height, glm::vec3(albedo));
  scene.geometry = std::move(geometry);
  return scene;
}

}  // namespace ssdo::test
