// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec4.hpp>

namespace ssdo {

/// The piece of surface that a pixel shows, in camera space. Half a cache line: a sample that lands
/// anywhere in the frame costs one.
struct alignas(32) Surfel {
  glm::vec4 position{0};  ///< xyz; w is 1 on a surface, 0 on background and broken pixels
  glm::vec4 normal{0};    ///< xyz: unit, on the viewer's side; w: distance by which the rounding of
                          ///< P as stored may have moved the position
};

}  // namespace ssdo
