// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "filters/filter_planes.h"

namespace ssdo {

/// Averages away the noise of a T x T sampling pattern, T = 1, 2, 4 or 8, among pixels of the same
/// surface; see geometry_filter.cpp. Every mean is finished as its plane asks; background pixels
/// keep their values.
FilterPlanes filter_geometry(FilterPlanes noisy, const Surfaces& guide, int pattern_size);

}  // namespace ssdo
