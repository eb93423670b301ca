// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>

#include "io/exr/file/exr_parts.h"
#include "math/downsampling.h"
#include "math/plane.h"

namespace ssdo {

/// Planes over the window `from` of a large picture become planes over the window of the small one
/// that covers it. A value is the mean of the pixels around it, weighted as a renderer's pixel
/// filter weighs samples; pixels outside of `from` have no weight. The same bits for any number of
/// threads.
Plane<float> filter_pixels(const Plane<float>& values, const Window& from,
                           const Downsampling& downsampling);
Plane<glm::vec3> filter_pixels(const Plane<glm::vec3>& values, const Window& from,
                               const Downsampling& downsampling);

/// The same of a stored channel without subsampling, in its type. Where values are no quantities,
/// `nearest` takes that of the pixel that covers the middle, or is right of it and below.
StoredChannel filter_stored(const StoredChannel& stored, const Window& from,
                            const Downsampling& downsampling, bool nearest);

}  // namespace ssdo
