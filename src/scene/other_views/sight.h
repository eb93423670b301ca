// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <glm/vec3.hpp>
#include <limits>

#include "scene/other_views/other_view.h"

namespace ssdo {

/// Points within so many footprints of the plane of what a picture shows are on that surface.
inline constexpr float kSurfaceTolerance = 3;

/// What another view knows about a point.
enum class Sight {
  unknown,  ///< outside of its picture, or behind what it shows
  surface,  ///< it shows a surface there
  rim,      ///< it shows one there in some of the pixels around the point, and looks past in others
  empty,    ///< it sees past the point: nothing solid is there
};

/// What another view knows about the points of one line.
class SightLine {
 public:
  /// `start` and the unit `direction` are in the camera space of the frame; the view must outlive
  /// this.
  SightLine(const OtherView& view, const glm::vec3& start, const glm::vec3& direction);

  /// What the four pixels around the picture of the point at distance `t` say. A view does not
  /// show what is narrower than a few of its pixels but looks past it: `width` is that of what the
  /// point would be in, in scene units.
  Sight at(float t, float width = std::numeric_limits<float>::infinity()) const;

  /// Whether any of these pixels shows a surface there.
  bool shows_surface(float t) const {
    const Sight sight = at(t);
    return sight == Sight::surface || sight == Sight::rim;
  }

 private:
  const OtherView* view_;
  glm::vec3 start_, direction_;  ///< in the camera space of the view
};

}  // namespace ssdo
