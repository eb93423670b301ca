// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "filters/filter_planes.h"

namespace ssdo {

/// A separable Gaussian that leaves out other depths and normals; see gaussian_filter.cpp. The size
/// of the pattern does not count. Means are finished as with filter_geometry(), after every
/// pass.
FilterPlanes filter_gaussian(FilterPlanes noisy, const Surfaces& guide, int pattern_size);

}  // namespace ssdo
