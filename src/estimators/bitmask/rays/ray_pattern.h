// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "scene/light/source.h"
#include "simd/interleaved.h"

namespace ssdo {

/// Source::point() by block of the pattern and member: the points of a source repeat after 2 x 2
/// blocks, row by row, so that the filter of wide penumbras sees four times as many.
using PointsOfSource =
    std::array<std::array<glm::vec3, Interleaving::kPeriod * Interleaving::kPeriod>, 4>;

/// Two independent sets of points of a source.
enum class RaySet { of_light, of_error };

/// Rays of each pixel to each source where it marches so many slices, a power of two: their noise
/// falls as that of the slices does.
int rays_to_source(int slices);

/// The points that rays of all pixels go to, one PointsOfSource for each of `rays`, a power of two.
/// They are spread evenly over the source within one block and within all four. `seed` permutes
/// them.
std::vector<PointsOfSource> points_of(const Source& source, int rays, unsigned seed,
                                      RaySet set = RaySet::of_light);

}  // namespace ssdo
