// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/estimator.h"
#include "scene/geometry.h"

namespace ssdo {

/// Averages away the noise of a T x T sampling pattern, T = 1, 2, 4 or 8, among pixels of the same
/// surface; see geometry_filter.cpp. Of the planes that exist, ao and reflection are held to 0..1
/// and bent is made unit again, zero staying zero; direct is taken as a share of light (shares.h),
/// the error as a signed difference. Background pixels keep their values.
Products filter_geometry(Products noisy, const Geometry& geometry, int pattern_size);

}  // namespace ssdo
