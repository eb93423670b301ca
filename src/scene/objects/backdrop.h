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
  double clearance = 0;   ///< ratio of its distance to that of all else, or to the height of the
                          ///< camera, over the least such ratio of a backdrop
  std::function<bool(const Surfel&)> has;  ///< whether a surface is of it

  /// Whether it counts as a backdrop by this frame alone. The frames of a shot decide together.
  bool is_far() const { return clearance >= 1; }
};

/// What has the shape of a backdrop, however far away it is; nothing where the frame shows none
/// (backdrop.cpp).
std::optional<Backdrop> find_backdrop(const Geometry& geometry);

}  // namespace ssdo
