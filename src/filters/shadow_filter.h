// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/products.h"
#include "scene/surfaces.h"

namespace ssdo {

/// The share of a sun by one ray of each pixel.
struct NoisyShadow {
  Plane<float> share;
  ShadowSample sample;
};

/// What the first pass leaves: the share, and W of shadow_filter.cpp in pixels, 0 where all
/// neighbours have the same share.
struct ShadowFound {
  Plane<float> share, penumbra;
};

/// The mean share of a sun that neighbours of a pixel on its surface have found, each by a ray to
/// another point of it, as far as the penumbra there is wide: see shadow_filter.cpp. `pattern_size`
/// is its T. Background pixels keep their values.
Plane<float> filter_shadow(NoisyShadow noisy, const Surfaces& guide, int pattern_size);

}  // namespace ssdo
