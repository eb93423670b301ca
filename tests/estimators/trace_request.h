// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/bitmask_request.h"
#include "estimators/trace.h"

namespace ssdo::test {

/// What a test asks of method trace.
struct TraceRequest {
  float radius = 1;
  ProductSet products = {.ao = true};
  int samples = 64;
  Environment environment = Environment::constant(glm::vec3(1));
  const HiddenGeometry* hidden = nullptr;
  float albedo = 0.8f;
  int bounces = 0;
};

inline Products run_trace(const Geometry& g, const TraceRequest& request) {
  const Plane<glm::vec3> albedo(g.surfel.width, g.surfel.height, glm::vec3(request.albedo)),
      no_radiance;
  std::optional<LightModel> light;
  if (!request.environment.is_constant())
    light = model_light(request.environment, g.world_to_camera);
  ProductSet products = request.products;
  products.bounce = request.bounces > 0;
  const ParameterValues parameters = {{"samples", double(request.samples)}};
  return trace_method().estimate({.geometry = g,
                                  .albedo = albedo,
                                  .radiance = no_radiance,
                                  .environment = request.environment,
                                  .products = products,
                                  .radius = request.radius,
                                  .bounces = request.bounces,
                                  .seed = 0,
                                  .parameters = parameters,
                                  .progress = {},
                                  .hidden = request.hidden,
                                  .light = light ? &*light : nullptr});
}

}  // namespace ssdo::test
