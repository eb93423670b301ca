// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "filters/filter_planes.h"

namespace ssdo {

/// Seven taps along rows and then columns, weighted by how alike the normals are; see
/// normal_filter.cpp. The size of the pattern does not count. Means are finished as with
/// filter_geometry(), after every pass.
FilterPlanes filter_normal(FilterPlanes noisy, const Surfaces& guide, int pattern_size);

}  // namespace ssdo
