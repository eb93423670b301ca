// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "math/plane.h"
#include "scene/geometry.h"
#include "simd/padded_plane.h"

namespace ssdo {

/// The depth of background: farther than all that is seen, so that "is it nearer than?" has the
/// right answer without a mask, a difference of depths is beyond every range, and the farthest of
/// several depths is background where one of them is. Not-a-number would have the first alone.
constexpr float kBackgroundDepth = -std::numeric_limits<float>::infinity();

/// Whether a depth of ViewPlanes, which DepthMips repeats, is that of a surface.
inline bool shows_surface(float z) { return z > kBackgroundDepth; }

/// The frame in the form for methods that look up places which differ from pixel to pixel. Pixels
/// are those of the data window, (0, 0) its upper left one, their centres at halves.
///
/// The position in the centre of a pixel follows from its depth: z (ray_x, ray_y, 1), or
/// (ray_x, ray_y, z) where the camera is orthographic.
struct ViewPlanes {
  PaddedLayout layout;
  bool orthographic;
  float fx, fy;            ///< pixels per unit of slope, or per scene unit
  float slope_x, slope_y;  ///< by which rays of neighbouring pixels differ
  float cx, cy;  ///< principal point in pixels from the display window's upper left corner: what is
                 ///< computed from it is the same for every crop
  /// The pixel (0, 0) in the display window, which patterns are fixed to. May be negative.
  int first_column, first_row;

  PaddedPlane z;             ///< camera space, negative in front of the viewer; or kBackgroundDepth
  const Surfaces& surfaces;  ///< normals and rounding; they count where z shows a surface
  std::vector<float> rays_x, rays_y;  ///< by column and by row, padded as planes are

  const float* ray_x() const { return rays_x.data() + PaddedLayout::kPad; }
  const float* ray_y() const { return rays_y.data() + PaddedLayout::kPad; }
  int width() const { return layout.width; }
  int height() const { return layout.height; }

  /// Without a camera. `shown` has to live as long as this.
  explicit ViewPlanes(const Surfaces& shown);
};

/// `geometry` has to live as long as the planes.
ViewPlanes make_view_planes(const Geometry& geometry);

}  // namespace ssdo
