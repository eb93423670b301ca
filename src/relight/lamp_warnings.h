// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "scene/geometry.h"
#include "scene/light/lamps/lamp.h"

namespace ssdo {

/// What is odd about a lamp in this frame, a line each: it gives no light, stands behind all that
/// is seen, is inside a surface, or lights no surface. `source` is that of the lamp.
std::vector<std::string> warnings_of(const Lamp& lamp, const Source& source,
                                     const Geometry& geometry);

}  // namespace ssdo
