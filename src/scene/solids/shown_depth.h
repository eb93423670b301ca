// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>

#include "scene/geometry.h"

namespace ssdo {

/// A run of pixels on one surface along a line of the frame. What lies beyond both ends is farther,
/// or nothing.
struct WholeRun {
  std::size_t first = 0;      ///< pixel
  std::ptrdiff_t stride = 0;  ///< from a pixel to the next
  int pixels = 0;
  float step_px = 1;                      ///< from a pixel to the next in the picture
  glm::vec3 first_edge{0}, last_edge{0};  ///< along the silhouettes at the ends, over `lines`
  int lines = 0;                          ///< beside the run that show the same two silhouettes
};

/// The depth of an object along the view rays, in scene units, by the sides that one run of its
/// pixels shows and by those that should be seen but are not; infinite where these give no limit.
/// See shown_depth.cpp.
float shown_depth(const Geometry& geometry, const WholeRun& run);

/// The least depth along the view ray of what a pixel shows, in scene units: its surface is closed
/// between this pixel and the next, up to a depth of kSurfaceGap pixels.
float least_depth(const Geometry& geometry, std::size_t pixel);

}  // namespace ssdo
