// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>

namespace ssdo {

/// Temperatures of light in kelvin that UsdLux knows, and the one that is white.
constexpr double kCoolestKelvin = 1000, kHottestKelvin = 10000, kWhiteKelvin = 6500;

/// Colour of a black body of that temperature in linear Rec. 709, of luminance 1; white at
/// kWhiteKelvin.
glm::dvec3 blackbody_color(double kelvin);

}  // namespace ssdo
