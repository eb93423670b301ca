// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/products.h"
#include "filters/registry.h"
#include "scene/surfaces.h"

namespace ssdo {

/// The products that exist, and their shares, after the filter: each as its row in the table of
/// products asks. The draws of suns are used up. `guide` is what each pixel shows.
Products filter_products(const Filter& filter, Products noisy, const Surfaces& guide,
                         int pattern_size);

}  // namespace ssdo
