// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "estimators/estimator.h"

namespace ssdo {

/// Numbers of 4 x 4 pixels, row by row: by which part of a turn the directions are turned, and
/// where in the first step the taps start, 0 to 1. Of seed 0 each has one number of every
/// sixteenth; other seeds shift them all by the same, so that consecutive ones spread evenly in
/// every pixel.
struct HbaoPattern {
  std::array<float, 16> turn, jitter;
};
HbaoPattern hbao_pattern(unsigned seed);

/// Horizon-based ambient occlusion in the form that games use; see hbao.cpp.
Method hbao_method();

}  // namespace ssdo
