// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "scene/light/environment.h"

namespace ssdo {

/// A concentrated source taken out of an environment.
struct Sun {
  glm::vec3 direction{0};    ///< unit, towards it
  float angular_radius = 0;  ///< radians, of the disc that holds its light; half a texel or more
  glm::vec3 irradiance{0};   ///< on a surface that faces it, over pi: unoccluded direct light is
                             ///< irradiance * cos
};

/// How bright a colour is whatever its space: the mean of its channels.
inline float brightness(const glm::vec3& c) { return (c.x + c.y + c.z) / 3; }

/// An environment in two parts whose light adds up to the whole.
struct SunsAndRest {
  std::vector<Sun> suns;  ///< strongest first, at most 4, directions in world space
  Environment rest;       ///< suns are filled with the radiance around them
};

/// Takes out what is within 5 degrees of a point and gives at least 5 % of the irradiance of a
/// surface that faces it. Not for a constant.
SunsAndRest take_suns(const Environment& whole);

}  // namespace ssdo
