// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>

namespace ssdo {

/// Lengths from here on count as infinite. The squares of shorter ones fit into a float, and Embree
/// takes no longer ones.
constexpr float kInfiniteLength = 1e18f;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

}  // namespace ssdo
