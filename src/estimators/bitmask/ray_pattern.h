// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "math/plane.h"
#include "scene/light/sun.h"
#include "simd/interleaved.h"

namespace ssdo {

/// A value for each member of the pattern of pixels.
template <class T>
using PerMember = std::array<T, Interleaving::kPeriod * Interleaving::kPeriod>;

/// At which distances in the picture the march of a ray samples, near to far.
using RayDistances = PerMember<std::vector<float>>;

/// `steps` is the number of those on a side of a slice; `display` the window of the picture.
RayDistances ray_distances(const Window& display, int steps);

/// Unit directions to points of a sun's disc, evenly spread.
PerMember<glm::vec3> directions_to(const Sun& sun);

}  // namespace ssdo
