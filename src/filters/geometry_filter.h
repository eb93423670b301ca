// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/estimator.h"
#include "scene/geometry.h"

namespace ssdo {

/// Averages away the noise of a T x T sampling pattern among pixels of the same surface; see
/// geometry_filter.cpp. Background pixels keep their values.
Products filter_geometry(const Products& noisy, const Geometry& geometry, int pattern_size);

}  // namespace ssdo
