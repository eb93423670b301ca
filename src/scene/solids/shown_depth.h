// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <limits>

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

/// Where the silhouette lies beside a pixel at the end of a run, in the mean: half a pixel
/// `outward` of its middle, in its tangent plane. `px` is the width of a pixel there.
glm::vec3 silhouette_beside(const Surfel& pixel, const glm::vec3& outward,
                            const glm::vec3& to_viewer, float px);

/// The mean depth of an object along the view rays, in scene units.
struct MeanDepth {
  float most = std::numeric_limits<float>::infinity();
  float shown = 0;  ///< by the sides in view alone
};

/// The depth of an object by the sides that one run of its pixels shows and by those that should be
/// seen but are not; `most` is infinite where these give no limit. See shown_depth.cpp.
MeanDepth shown_depth(const Geometry& geometry, const WholeRun& run);

/// The least depth along the view ray of what a pixel shows, in scene units: its surface is closed
/// between this pixel and the next, up to a depth of kSurfaceGap pixels.
float least_depth(const Geometry& geometry, std::size_t pixel);

}  // namespace ssdo
