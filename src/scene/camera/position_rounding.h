// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/gbuffer.h"

namespace ssdo {

/// The most by which storing P may have moved it along one axis, in scene units.
double rounding_of_positions(const GBuffer& g);

}  // namespace ssdo
