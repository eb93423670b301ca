// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

namespace ssdo::test {

/// Surfaces of one albedo in light from `environment`, infinitely thick.
Scene scene_of(Geometry geometry,
               const Environment& environment = Environment::constant(glm::vec3(1)),
               float albedo = 0);

}  // namespace ssdo::test
