// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "filters/filter_planes.h"

namespace ssdo {

/// The mean of the T x T pixels of the sampling pattern, across edges; see box_filter.cpp. Means
/// are finished as with filter_geometry().
FilterPlanes filter_box(FilterPlanes noisy, const Surfaces& guide, int pattern_size);

}  // namespace ssdo
