// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "scene/camera/camera.h"

namespace ssdo {

/// Width of what a pixel shows, in scene units.
class PixelFootprint {
 public:
  explicit PixelFootprint(const Camera& camera)
      : orthographic_(camera.orthographic), per_depth_(float(1 / std::min(camera.fx, camera.fy))) {}

  /// Width of a pixel on a surface that faces the viewer at this depth along the axis.
  float at(float depth) const { return orthographic_ ? per_depth_ : depth * per_depth_; }

 private:
  bool orthographic_;
  float per_depth_;
};

}  // namespace ssdo
