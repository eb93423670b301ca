// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "scene/light/light.h"

namespace ssdo {

/// The light's coefficients, channel by channel, times the constants of orthonormal spherical
/// harmonics, which the polynomials of the march lack. For light of order 0: 1 for band 0, else 0.
std::vector<float> basis_weights(const Light& light, int order);

}  // namespace ssdo
