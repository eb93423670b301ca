// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/estimator.h"
#include "scene/scene.h"

namespace ssdo::test {

/// 130 x 70 pixels, of 3 x 2 tiles: a floor, a wall and two balls before a background, under a sky
/// with two suns. It comes of sums, products, quotients and square roots of doubles, which IEEE 754
/// rounds in one way: any compiler and library make the same bits of it.
Scene fixed_scene();

/// All that a method makes of the scene within a radius, with few samples.
Request fixed_request(const Method& method, float radius);

}  // namespace ssdo::test
