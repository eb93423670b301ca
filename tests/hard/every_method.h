// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "estimators/registry.h"
#include "hard/hard_cases.h"
#include "scene/hidden_geometry.h"
#include "scene/light_model.h"

namespace ssdo::test {

/// All that a method makes of a frame under a light, before a filter. `set` as with --set.
inline Products run_method(const Method& method, const HardFrame& frame, const LightModel* light,
                           const std::vector<std::string>& set = {}) {
  const Geometry& g = frame.geometry;
  const ParameterValues parameters = resolve_parameters(method, set);
  const Plane<glm::vec3> no_radiance;
  const HiddenGeometry hidden = method.looks_behind() ? find_hidden_geometry(g) : HiddenGeometry();
  const int bounces = method.products.bounce ? frame.bounces : 0;
  EstimateInput in{
      g, frame.albedo, no_radiance, frame.environment, method.products, frame.radius, bounces,
      0, parameters,   {}};
  in.hidden = &hidden;
  in.light = light;
  return method.estimate(in);
}

template <class Value>
bool same_bits(const Plane<Value>& a, const Plane<Value>& b) {
  return a.size() == b.size() &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.size() * sizeof(Value)) == 0;
}

inline bool same_bits(const Products& a, const Products& b) {
  return same_bits(a.ao, b.ao) && same_bits(a.direct, b.direct) && same_bits(a.bounce, b.bounce) &&
         same_bits(a.bent, b.bent) && same_bits(a.reflection, b.reflection) &&
         same_bits(a.error, b.error);
}

}  // namespace ssdo::test
