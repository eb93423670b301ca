// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "estimators/products.h"
#include "scene/gbuffer.h"
#include "scene/scene.h"

namespace ssdo {

/// The products with pixels shown unoccluded, as far as GBuffer::masks keeps them: ao and the like
/// 1, direct light unoccluded, bent normals those of the surface, all else 0. Nothing where no
/// pixel is kept.
std::optional<Products> open_kept_pixels(const Products& found, const Scene& scene,
                                         const GBuffer& gbuffer);

/// The share of a pixel that is not kept: 1 where no pixel is.
inline float changed_share(const GBuffer& gbuffer, std::size_t pixel) {
  return gbuffer.masks.kept.empty() ? 1.0f : 1 - gbuffer.masks.kept[pixel];
}

}  // namespace ssdo
