// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>

#include "color/results.h"
#include "estimators/products.h"
#include "math/plane.h"

namespace ssdo {

/// Coverage of the pixels of the G-buffer: the input's alpha where there is one, else 1 on
/// surfaces; 0 outside the geometry.
Plane<float> coverage(const Scene& scene, const GBuffer& gbuffer);

/// A colour for every pixel of the G-buffer, premultiplied or a weight, over the window of outputs:
/// the mean under the pixel filter.
template <class T>
Plane<T> at_output_size(Plane<T> values, const GBuffer& gbuffer);

/// The weight of each pixel of the G-buffer in means over surfaces: its coverage, 0 where there is
/// nothing to light; for weights_by_albedo(), times its albedo. Weights other than 0 are 1
/// where a pixel of an output is one of the G-buffer.
Plane<float> weights_by_coverage(const Results& results);
Plane<glm::vec3> weights_by_albedo(const Results& results);

/// A product over the window of outputs: its mean over the surfaces that a pixel shows, with its
/// background where there is none. Light is weighted by albedo, all else by coverage; a direction
/// has length 1 again. So albedo times light, both at that size, is what surfaces send there.
Plane<float> product_at_output_size(const Product& product, const Plane<float>& values,
                                    const Results& results);
Plane<glm::vec3> product_at_output_size(const Product& product, const Plane<glm::vec3>& values,
                                        const Results& results);

}  // namespace ssdo
