// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/estimator.h"
#include "scene/geometry.h"

namespace ssdo {

/// Nine taps, two pixels apart, along rows and then columns, weighted by how near they are in
/// depth; see depth_filter.cpp. The size of the pattern does not count. What is done to each
/// product is as with filter_geometry(), after every pass.
Products filter_depth(Products noisy, const Geometry& geometry, int pattern_size);

}  // namespace ssdo
