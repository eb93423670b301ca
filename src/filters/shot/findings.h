// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "estimators/products.h"
#include "scene/geometry.h"

namespace ssdo {

/// A plane of what was found.
struct FoundPlane {
  static constexpr int kOfAll = -1, kOfSenders = -2;

  int channels = 0;     ///< 0: it is empty
  int source = kOfAll;  ///< number of the source whose shadow it is, or another thing it is of
  bool bends = false;   ///< directions, which are kept in world space
};

/// What one frame has found of its surfaces, as it and the other frames of its shot look at it: the
/// shares of the light that arrive, before light is made of them.
struct Findings {
  static constexpr int kGroup = 8;  ///< channels of a pixel are padded to a multiple

  std::shared_ptr<const Geometry> geometry;
  std::vector<FoundPlane> planes;  ///< in the order of for_each_found()
  int stride = 0;                  ///< channels of a pixel, with padding
  /// By channel, a power of two near the mean of its plane, which values are stored in units of:
  /// light has any scale, and half numbers have not.
  std::vector<float> unit;
  /// Half numbers (IEEE 754), pixel after pixel: one that another frame looks up lies in one or two
  /// cache lines.
  std::vector<std::uint16_t> values;
  Plane<float> glow;  ///< luminance of the radiance; empty: nothing glows
};

/// Moves what frames share out of `products`, and the geometry with it. `radiance` is that of
/// surfaces that glow; it may be empty.
Findings take_findings(Products& products, Geometry geometry, const Plane<glm::vec3>& radiance);

/// Calls visit(plane, number of its source or what else it is of, whether it holds directions) for
/// all planes that frames share, some of which may be empty. What the view of a camera decides,
/// such as reflections, is not among them, nor is the error.
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
  visit(products.shares.sky, FoundPlane::kOfAll, false);
  for (std::size_t k = 0; k < products.shares.suns.size(); ++k)
    visit(products.shares.suns[k], int(k), false);
}

}  // namespace ssdo
