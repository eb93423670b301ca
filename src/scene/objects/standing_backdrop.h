// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "scene/objects/backdrop_shapes.h"

namespace ssdo {

/// Cards, sides of a box, a cylinder or a sweep that stand on a flat ground, by samples of a frame,
/// however far away they are; nothing where there are none (standing_backdrop.cpp).
std::optional<BackdropShape> find_standing_backdrop(const SurfelSamples& samples);

}  // namespace ssdo
