// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "math/plane.h"
#include "scene/geometry.h"

namespace ssdo {

/// A surface that stands for the sky: around or behind all else that a frame shows, and far away.
struct Backdrop {
  Plane<float> coverage;  ///< 1 in pixels that show it
  double share = 0;       ///< of the frame's pixels
  std::string what;       ///< for messages: "a dome of radius 500 around everything"
  double clearance = 0;   ///< how much farther away it is than all else, or than the camera is high
                          ///< above the ground, over the least of a backdrop
  std::function<bool(const Surfel&)> has;  ///< whether a surface is of it

  /// Whether it is one by this frame alone. In a shot the frames are asked together.
  bool is_far() const { return clearance >= 1; }
};

/// What has the shape of a backdrop, however far away it is; nothing where the frame shows none
/// (backdrop.cpp).
std::optional<Backdrop> find_backdrop(const Geometry& geometry);

}  // namespace ssdo
