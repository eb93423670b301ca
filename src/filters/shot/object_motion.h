// SPDX-License-Identifier: Apache-2.0
//
// The motion of visible surfaces apart from that of the camera.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "filters/shot/kept_surfaces.h"
#include "math/bf16x2.h"
#include "math/plane.h"

namespace ssdo {

/// Motion since the frame before in time, in pixels, x right and y down, of which that of the
/// cameras is subtracted.
struct ObjectMotion {
  /// If nothing in a frame moves more, the motion may be noise of P and of a layer of half numbers.
  static constexpr float kLeast = 1.0f / 16;

  bool is_known = false;      ///< a layer tells it
  bool contradicts = false;   ///< the layer: it is not used
  std::vector<float> pixels;  ///< pack_bf16x2(), by KeptSurfaces::index(); empty: nothing moves

  /// Not finite where the layer says nothing.
  glm::dvec2 at(std::size_t i) const {
    if (pixels.empty()) return glm::dvec2(0);
    return {double(unpack_bf16_first(pixels[i])), double(unpack_bf16_second(pixels[i]))};
  }
};

/// The velocity of a pixel of `now` across the view, apart from the camera's motion: camera space,
/// scene units in a frame. 0 where unknown.
glm::vec3 velocity_of(const ObjectMotion& motion, const KeptSurfaces& now, std::size_t pixel);

/// `layer` leads from each pixel of `now` to where what it shows was in `before`, in pixels, x
/// right and y down. Both must know the world. Surfaces that P shows at the same place in both
/// frames stand still; a layer that contradicts the cameras there (MotionRatios) has other units.
ObjectMotion find_object_motion(const Plane<glm::vec2>& layer, const KeptSurfaces& now,
                                const KeptSurfaces& before);

}  // namespace ssdo
