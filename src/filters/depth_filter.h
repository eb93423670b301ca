// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "filters/filter_planes.h"

namespace ssdo {

/// Nine taps, two pixels apart, along rows and then columns, weighted by how near they are in
/// depth; see depth_filter.cpp. The size of the pattern does not count. Means are finished as
/// with filter_geometry(), after every pass.
FilterPlanes filter_depth(FilterPlanes noisy, const Surfaces& guide, int pattern_size);

}  // namespace ssdo
