// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <glm/vec3.hpp>

#include "estimators/estimator.h"

namespace ssdo {

Method ssao_fade_method();

/// The directions and lengths that all pixels share: towards the corners and the faces of a cube,
/// as long as a random number in 0.25..1.
std::array<glm::vec3, 14> fade_offsets(unsigned seed);

/// 4 x 4 random vectors, row by row, each coordinate in -1..1: not of unit length.
std::array<glm::vec3, 16> fade_noise(unsigned seed);

}  // namespace ssdo
