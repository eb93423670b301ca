// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "estimators/estimator.h"
#include "math/plane.h"
#include "scene/gbuffer.h"
#include "scene/geometry.h"

namespace ssdo {

/// A plane with the channel name that it has in an output EXR.
struct NamedPlane {
  std::string channel;
  Plane<float> pixels;
};

/// Coverage: the input's alpha where there is one, else 1 on surfaces; 0 outside the geometry.
Plane<float> coverage(const GBuffer& gbuffer, const Geometry& geometry);

/// albedo (direct + bounce), not premultiplied.
Plane<glm::vec3> composite(const GBuffer& gbuffer, const Products& products);

/// The channels of one product: R G B A (premultiplied) for "composite", ao.Y, error.Y,
/// reflection.Y, bent.X/Y/Z in the space of the input's normals, direct.R/G/B, bounce.R/G/B.
std::vector<NamedPlane> product_channels(const std::string& product, const GBuffer& gbuffer,
                                         const Geometry& geometry, const Products& products);

}  // namespace ssdo
