// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/gbuffer.h"
#include "support/analytic_scene.h"

namespace ssdo::test {

/// P and N of a picture as a file of floats gives them.
GBuffer gbuffer_of(const Picture& picture);

}  // namespace ssdo::test
