// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/gbuffer.h"
#include "support/analytic_scene.h"

namespace ssdo::test {

/// P and N of a picture as a file of floats gives them.
inline GBuffer gbuffer_of(const Picture& picture) {
  GBuffer g;
  g.window = g.display = picture.window;
  g.position = picture.position;
  g.normal = picture.normal;
  g.valid = picture.valid;
  g.position_step = 1.0f / 16777216;
  return g;
}

}  // namespace ssdo::test
