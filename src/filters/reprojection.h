// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "scene/camera/camera_change.h"
#include "scene/geometry.h"

namespace ssdo {

/// What the frame before shows at the place of a point of the present frame.
enum class SeenBefore {
  nothing,  ///< the point is outside that picture, or something may hide it
  same,     ///< its surface
  through,  ///< what lies behind the point: it was not there
};

/// Pixels of the frame before that show a point of the present frame, with weights whose sum is 1.
struct PixelsBefore {
  std::size_t pixel[4];
  float weight[4];
  int count = 0;
  SeenBefore sight = SeenBefore::nothing;  ///< `same` where there are pixels
};

/// Finds in the frame before what a pixel shows.
class Reprojection {
 public:
  static constexpr double kSameNormal = 0.9;  ///< normals 26 degrees apart belong to two surfaces
  static constexpr double kLeastShare = 0.1;  ///< of the bilinear weight
  static constexpr double kBehind = 0.02;     ///< of the depth; farther is another surface

  /// Both must know the world.
  Reprojection(const Geometry& before, const Geometry& now);

  /// From the camera space of the frame before to the present one.
  glm::mat3 to_present() const { return glm::mat3(glm::transpose(change_.turn)); }

  /// Where the camera before saw a point of the present camera space, had the point not moved:
  /// pixels of the display window. Not finite where that camera looked away.
  glm::dvec2 place(const glm::vec3& position) const {
    return change_.place(change_.position(position));
  }

  /// `from_motion` is the pixel in the frame before according to a motion layer; not finite without
  /// one.
  PixelsBefore find(const Surfel& surfel, const glm::dvec2& from_motion) const;

 private:
  const Geometry& before_;
  const CameraChange change_;
  const glm::dvec2 pixel_size_;  ///< at depth 1, or at any where the camera is orthographic
};

/// The centre of a pixel of the data window, in pixels of the display window.
inline glm::dvec2 centre_of(const Geometry& geometry, int x, int y) {
  return {geometry.window.x0 + x + 0.5, geometry.window.y0 + y + 0.5};
}

}  // namespace ssdo
