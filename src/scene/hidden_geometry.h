// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/plane.h"
#include "scene/geometry.h"

namespace ssdo {

/// What a frame does not show but suggests; see hidden_geometry.cpp. Lengths are in scene units
/// along the view ray, infinite where there is nothing.
struct HiddenGeometry {
  /// From the front of what is seen to its back.
  Plane<float> thickness;
  /// From the front of what is seen to the surface that it covers, and the pixel that shows where
  /// this surface is not covered. Empty: nothing goes on behind anything.
  Plane<float> behind;
  Plane<int> behind_source;
};

/// Neighbours are on one surface when neither lies farther than this from the other's tangent
/// plane, in pixel footprints.
constexpr float kSurfaceGap = 4;

HiddenGeometry find_hidden_geometry(const Geometry& geometry);

/// Everything is as thick as `thickness`, which may be infinite.
HiddenGeometry constant_thickness(const Geometry& geometry, float thickness);

}  // namespace ssdo
