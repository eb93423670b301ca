// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "scene/light/light.h"

namespace ssdo {

/// The light's coefficients, channel by channel, times the constants that make spherical harmonics
/// orthonormal, which the polynomials of the march lack. Light of order 0 has band 0 alone.
std::vector<float> basis_weights(const Light& light, int order);

}  // namespace ssdo
