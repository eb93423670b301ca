// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "estimators/view_space/view_planes.h"

namespace ssdo {

/// A frame at half its width and height: the lower right one of every 2 x 2 pixels of the display
/// window, which a lookup at their common corner gives. Where the data window lacks that pixel, its
/// neighbour in the window.
class HalfResolution {
 public:
  /// `full` are planes of the frame, which have to live as long as this.
  explicit HalfResolution(const ViewPlanes& full);
  HalfResolution(const HalfResolution&) = delete;  // receivers_ points into it
  HalfResolution& operator=(const HalfResolution&) = delete;

  /// The pixels that are evaluated, with their own rays. Only receivers: points are projected to
  /// the full planes.
  const ViewPlanes& receivers() const { return receivers_; }

  /// What those pixels show, for filters of values at half resolution.
  const Surfaces& surfels() const { return surfels_; }

  /// Bilinear upsampling of values at half resolution, as textures have it: it takes a value to
  /// lie in the middle of its 2 x 2 pixels and knows nothing of edges. Background: 1.
  Plane<float> upsample_bilinear(const Plane<float>& half) const;

  /// The same four values, each weighted by how well its pixel's position lies on the tangent
  /// plane of the pixel that asks; where none does, the value of the pixel nearest in depth.
  /// Background: 1. Needs the normals of the full planes.
  Plane<float> upsample_along_surfaces(const Plane<float>& half) const;

  /// The entries of the half frame around the pixels of the full one, along one axis; padded at
  /// the end by a vector.
  struct Taps {
    std::vector<int> before, after;
    std::vector<float> share;  ///< of the one after, 0..1
  };

 private:
  /// The column, and the row, of the frame that one of the half frame is evaluated at.
  int column(int x) const;
  int row(int y) const;
  Surfaces sampled_surfels() const;

  const ViewPlanes& full_;
  Taps columns_, rows_;
  Surfaces surfels_;
  ViewPlanes receivers_;
};

}  // namespace ssdo
