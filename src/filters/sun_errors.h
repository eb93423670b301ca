// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/products.h"
#include "scene/scene.h"

namespace ssdo {

/// Adds to the product `error` the noise of the suns, where rays went to other points of them too;
/// see sun_errors.cpp.
void add_sun_errors(Products& products, const Scene& scene);

}  // namespace ssdo
