// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>

namespace ssdo {

/// Of a linear colour with Rec. 709 primaries (ITU-R BT.709); close enough to rank others.
inline float luminance(const glm::vec3& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }

}  // namespace ssdo
