// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "parallel/interleaved.h"
#include "scene/geometry.h"
#include "scene/hidden_geometry.h"

namespace ssdo {

/// Values of the pixels at the frame's border: its first row, its last row, its first column, its
/// last column.
using BorderValues = std::vector<float>;

/// The frame as a march reads it. Planes are not-a-number where there is nothing.
///
/// Depths behind something are a share of its distance to the viewer, or a length in scene units
/// where the camera is orthographic.
struct MarchScene {
  Interleaving layout;
  bool orthographic;
  float fx, fy;                 ///< pixels per unit of slope, or per scene unit
  InterleavedPlane x, y, z;     ///< position, camera space
  InterleavedPlane nx, ny, nz;  ///< unit normal
  InterleavedPlane rounding;    ///< distance by which storing P may have moved it
  InterleavedPlane thickness;   ///< from the front to the back
  InterleavedPlane behind;      ///< from the front to the surface that it covers
  InterleavedPlane behind_thickness;
  BorderValues border_position[3], border_normal[3];
  BorderValues border_thickness;  ///< in scene units
};

/// What is endless, in the units of MarchScene: within 1e-4 of the direction of the view ray.
constexpr float kEndlessShare = 1e4f, kEndlessLength = 1e15f;

/// Values of all pixels at the frame's border, in the order of BorderValues.
template <class Value>
BorderValues border_values(int width, int height, const Value& value) {
  BorderValues values;
  values.reserve(2 * std::size_t(width + height));
  for (const int y : {0, height - 1}) {
    for (int x = 0; x < width; ++x) values.push_back(value(x, y));
  }
  for (const int x : {0, width - 1}) {
    for (int y = 0; y < height; ++y) values.push_back(value(x, y));
  }
  return values;
}

/// `hidden` may be null: then all that is seen is endless.
MarchScene make_march_scene(const Geometry& geometry, const HiddenGeometry* hidden);

}  // namespace ssdo
