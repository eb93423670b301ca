// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/estimator.h"
#include "scene/geometry.h"

namespace ssdo {

/// The mean of the T x T pixels of the sampling pattern, across edges; see box_filter.cpp. What is
/// done to each product is as with filter_geometry().
Products filter_box(Products noisy, const Geometry& geometry, int pattern_size);

}  // namespace ssdo
