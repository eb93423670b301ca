// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "estimators/bitmask/jobs.h"
#include "estimators/bitmask/raster.h"
#include "estimators/estimator.h"
#include "estimators/products.h"

namespace ssdo {

/// What rays to mirrored things look at.
struct ReflectionInput {
  March march;
  const Raster& raster;
  const Scene& scene;
  const Request& request;
  const InterleavedVectors& sent;  ///< as SenderJob has it; no planes: surfaces send nothing
  Window lit;                      ///< the pixels whose radiance is known
  bool two_sided;
};

/// Makes the product `reflection` and what `specular` is made of, as far as the request has them.
void find_reflection(const ReflectionInput& input, Products& products, const Progress& progress);

}  // namespace ssdo
