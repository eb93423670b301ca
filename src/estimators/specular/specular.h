// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/products.h"
#include "scene/scene.h"

namespace ssdo {

/// The product `specular` from what a method, and a filter, have found for it:
///
///   specular = sky S + R H + sum over sources of source_k s_k
///
/// sky, source_k: light that is mirrored without occluders (specular/mirrored_light-inl.h)
/// S, s_k:        LightVisibility::mirrored_sky and LightVisibility::sources
/// R, H:          what is mirrored of even light, and Products::specular as it comes in
///
/// So a filter averages S and H, but not the detail that normal maps give to mirrored lights. Does
/// nothing where the product is not made; outside of surfaces it is 0.
void add_specular(Products& products, const Scene& scene);

}  // namespace ssdo
