// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "scene/light/sun.h"
#include "simd/interleaved.h"

namespace ssdo {

/// A value for each member of the pattern of pixels.
template <class T>
using PerMember = std::array<T, Interleaving::kPeriod * Interleaving::kPeriod>;

/// Points of a sun that have nothing to do with those of the other set.
enum class RaySet { of_light, of_error };

/// Rays of each pixel to each sun where it marches so many slices, a power of two: their noise
/// falls as that of the slices does.
int rays_to_sun(int slices);

/// Unit directions to points of a sun, evenly spread: for each of `rays`, a power of two, those of
/// the members. Another seed exchanges them.
std::vector<PerMember<glm::vec3>> directions_to(const Sun& sun, int rays, unsigned seed,
                                                RaySet set = RaySet::of_light);

}  // namespace ssdo
