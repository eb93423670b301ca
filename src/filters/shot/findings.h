// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <type_traits>
#include <vector>

#include "estimators/products.h"
#include "filters/shot/kept_surfaces.h"
#include "filters/shot/object_motion.h"
#include "math/uninitialized.h"
#include "scene/geometry.h"

namespace ssdo {

/// A plane of what was found.
struct FoundPlane {
  static constexpr int kOfAll = -1, kOfSenders = -2;

  int channels = 0;           ///< 0: it is empty
  int source = kOfAll;        ///< the source whose shadow it is, or kOfAll or kOfSenders
  bool is_direction = false;  ///< directions, which are kept in world space
};

/// What one frame has found of its surfaces, as it and the other frames of its shot look at it: the
/// shares of the light that arrive, before light is made of them.
struct Findings {
  static constexpr int kGroup = 8;  ///< channels of a pixel are padded to a multiple

  KeptSurfaces surfaces;
  std::vector<FoundPlane> planes;  ///< in the order of for_each_found()
  int stride = 0;                  ///< channels of a pixel, with padding
  /// The unit of the values, by channel: a power of two near the mean of the plane. Light may have
  /// any scale, which half numbers alone could not hold.
  std::vector<float> unit;
  /// Finite half numbers (IEEE 754), pixel after pixel by KeptSurfaces::index(): the pixel that
  /// another frame looks up lies in one or two cache lines.
  std::vector<std::uint16_t, Uninitialized<std::uint16_t>> values;
  /// Luminance of the radiance, in the same order; empty: nothing glows.
  std::vector<float> glow;
  ObjectMotion motion;  ///< since the frame before in time
};

/// Moves what frames share out of `products`. `radiance` is that of surfaces that glow; it may be
/// empty.
Findings take_findings(Products& products, const Geometry& geometry,
                       const Plane<glm::vec3>& radiance);

/// `v` turned as the unit vector `a` is turned to the unit vector `b` by the shortest way, as
/// find_visibility() turns bent normals.
inline glm::vec3 turned(const glm::vec3& v, const glm::vec3& a, const glm::vec3& b) {
  const glm::vec3 both = a + b;
  return v - glm::dot(both, v) / std::max(1 + glm::dot(a, b), 1e-6f) * both +
         2 * glm::dot(a, v) * b;
}

template <class T>
constexpr int channels_of() {
  return std::is_same_v<T, float> ? 1 : 3;
}

/// Calls visit(plane, number of its source or what else it is of, whether it holds directions) for
/// all planes that frames share, some of which may be empty. Planes that depend on the view, such
/// as reflections, are not among them, nor is the error.
template <class Visit>
void for_each_found(const Visit& visit, Products& products) {
  for_each_plane(
      [&](const Product& product, auto& plane) {
        if (product.kind == ProductKind::deviation || product.of_view) return;
        const bool is_sent = product.filtering.coupling == Coupling::occluders;
        visit(plane, is_sent ? FoundPlane::kOfSenders : FoundPlane::kOfAll,
              product.kind == ProductKind::direction);
      },
      products);
  visit(products.visibility.sky, FoundPlane::kOfAll, false);
  for (std::size_t k = 0; k < products.visibility.sources.size(); ++k)
    visit(products.visibility.sources[k], int(k), false);
}

}  // namespace ssdo
