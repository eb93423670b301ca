// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "estimators/registry.h"
#include "estimators/ssdo.h"
#include "support/scene_of.h"

namespace ssdo::test {

/// What a test asks of the method; the rest are its defaults.
struct SsdoRequest {
  float radius = 1;
  Environment environment = Environment::constant(glm::vec3(1));
  std::vector<std::string> set = {};
  float albedo = 0.5f;
  int bounces = 0;
  unsigned seed = 0;
  Plane<glm::vec3> radiance = {};
};

inline Products run_ssdo(const Geometry& geometry, const SsdoRequest& request) {
  const Method method = ssdo_method();
  Scene scene = scene_of(geometry, request.environment, request.albedo);
  scene.senders.radiance = request.radiance;
  return method.estimate(scene,
                         {.products = {.ao = true, .direct = true, .bounce = request.bounces > 0},
                          .radius = request.radius,
                          .bounces = request.bounces,
                          .seed = request.seed,
                          .parameters = resolve_parameters(method, request.set)},
                         {});
}

}  // namespace ssdo::test
