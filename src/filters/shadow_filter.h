// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/products.h"
#include "scene/geometry.h"

namespace ssdo {

/// The mean share of a sun that neighbours of a pixel on its surface have found, each by a ray to
/// another point of it, as far as the penumbra there is wide: see shadow_filter.cpp. `pattern_size`
/// is the most. Background pixels keep their values.
Plane<float> filter_shadow(Plane<float> share, ShadowDraw draw, const Geometry& geometry,
                           int pattern_size);

}  // namespace ssdo
