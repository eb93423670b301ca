// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "math/plane.h"

namespace ssdo {

/// How many pixels of a mask are not 0.
std::size_t count_marked(const Plane<unsigned char>& mask);

/// The indices of every `stride`-th such pixel in the order of rows, from the first on.
std::vector<std::size_t> every_marked(const Plane<unsigned char>& mask, std::size_t stride);

}  // namespace ssdo
