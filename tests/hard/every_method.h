// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "estimators/registry.h"
#include "hard/hard_cases.h"
#include "support/scene_of.h"

namespace ssdo::test {

/// All that a method makes of a frame in its light, before a filter. `set` as with --set.
inline Products run_method(const Method& method, const HardFrame& frame,
                           const std::vector<std::string>& set = {}) {
  Scene scene = scene_of(frame.geometry, frame.environment);
  scene.senders.albedo = frame.albedo;
  if (method.supports.thickness) scene.solids = guess_solids(frame.geometry);
  return method.estimate(scene,
                         {.products = method.products,
                          .radius = frame.radius,
                          .bounces = method.products.bounce ? frame.bounces : 0,
                          .parameters = resolve_parameters(method, set)},
                         {});
}

template <class Value>
bool same_bits(const Plane<Value>& a, const Plane<Value>& b) {
  return a.size() == b.size() &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.size() * sizeof(Value)) == 0;
}

inline bool same_bits(const Products& a, const Products& b) {
  bool same = true;
  for_each_plane([&](const Product&, const auto& one,
                     const auto& other) { same = same && same_bits(one, other); },
                 a, b);
  return same;
}

}  // namespace ssdo::test
