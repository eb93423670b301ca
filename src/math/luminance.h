// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>

namespace ssdo {

/// Weights of the channels in the luminance of a linear colour with Rec. 709 primaries (ITU-R
/// BT.709); close enough to rank colours of other primaries.
constexpr float kLumaRed = 0.2126f, kLumaGreen = 0.7152f, kLumaBlue = 0.0722f;

inline float luminance(const glm::vec3& c) {
  return kLumaRed * c.x + kLumaGreen * c.y + kLumaBlue * c.z;
}

}  // namespace ssdo
