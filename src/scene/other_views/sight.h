// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <glm/vec3.hpp>
#include <limits>

#include "scene/other_views/other_view.h"

namespace ssdo {

/// Points within this many footprints of the tangent plane of a surface in a picture are on this
/// surface.
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

  /// What the four pixels around the projection of the point at distance `t` show. A view may look
  /// past things narrower than a few of its pixels: `width` is that of the solid that the point
  /// would be in, in scene units.
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
