// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/bitmask/request.h"
#include "estimators/trace.h"

namespace ssdo::test {

/// What a test asks of method trace.
struct TraceRequest {
  float radius = 1;
  ProductSet products = {.ao = true};
  int samples = 64;
  Environment environment = Environment::constant(glm::vec3(1));
  const Solids* solids = nullptr;
  float albedo = 0.8f;
  int bounces = 0;
};

inline Products run_trace(const Geometry& g, const TraceRequest& request) {
  Scene scene = scene_of(g, request.environment, request.albedo);
  if (request.solids) scene.solids = *request.solids;
  ProductSet products = request.products;
  products.bounce = request.bounces > 0;
  return trace_method().estimate(scene,
                                 {.products = products,
                                  .radius = request.radius,
                                  .bounces = request.bounces,
                                  .parameters = {{"samples", double(request.samples)}}},
                                 {});
}

}  // namespace ssdo::test
