// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfHeader.h>

#include <glm/vec3.hpp>

#include "math/plane.h"

namespace ssdo {

/// Whether a header says that its part is a cube map: the attribute envmap of OpenEXR.
bool is_cube_map(const Imf::Header& header);

/// The light of a cube map, n x 6n texels, as a lat-long map: longitude = atan2(x, z), latitude =
/// asin(y) of the cube's axes, the date line and the poles at the outer edges. OpenEXR places the
/// texels of a face's border on the edges of the cube (ImfEnvmap.h); between texels of a face,
/// light is bilinear.
Plane<glm::vec3> lat_long_of_cube(const Plane<glm::vec3>& cube);

}  // namespace ssdo
