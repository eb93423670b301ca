// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <glm/vec3.hpp>

#include "scene/light/sun.h"
#include "simd/interleaved.h"

namespace ssdo {

/// A value for each member of the pattern of pixels.
template <class T>
using PerMember = std::array<T, Interleaving::kPeriod * Interleaving::kPeriod>;

/// Unit directions to points of a sun, evenly spread; another seed exchanges them.
PerMember<glm::vec3> directions_to(const Sun& sun, unsigned seed);

}  // namespace ssdo
