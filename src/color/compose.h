// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "estimators/estimator.h"
#include "math/plane.h"
#include "scene/gbuffer.h"
#include "scene/scene.h"

namespace ssdo {

/// A plane with the channel name that it has in an output EXR.
struct NamedPlane {
  std::string channel;
  Plane<float> pixels;
};

/// Coverage: the input's alpha where there is one, else 1 on surfaces; 0 outside the geometry.
Plane<float> coverage(const Scene& scene, const GBuffer& gbuffer);

/// albedo (direct + bounce); or, where the ambient part of the render is known, that part times ao
/// with the rest of the beauty, where there is one, as it was. Not premultiplied.
Plane<glm::vec3> composite(const Scene& scene, const GBuffer& gbuffer, const Products& products);

/// The channels of the product `name`, as the table of products has them: directions in the space
/// of the input's normals, the composite premultiplied.
std::vector<NamedPlane> product_channels(const std::string& name, const Scene& scene,
                                         const GBuffer& gbuffer, const Products& products);

}  // namespace ssdo
