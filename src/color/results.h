// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "color/composition.h"
#include "estimators/estimator.h"
#include "scene/gbuffer.h"
#include "scene/scene.h"

namespace ssdo {

/// A frame and what was found for it: what outputs are made from.
struct Results {
  const Scene& scene;
  const GBuffer& gbuffer;
  const Products& products;
  Composition composition = {};
  const Products* opened = nullptr;  ///< open_kept_pixels() of them; null: no pixels are kept

  /// The products as outputs hold them.
  const Products& shown() const { return opened ? *opened : products; }
};

}  // namespace ssdo
