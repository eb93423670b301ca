// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "io/primaries.h"
#include "math/plane.h"

namespace ssdo {

/// A lat-long map as a file holds it.
struct EnvironmentMap {
  Plane<glm::vec3> texels;  ///< over the display window; every channel from 0 to kBrightest
  std::string layer;        ///< or part of an EXR; empty: channels without either
  std::optional<Chromaticities> primaries;  ///< what the file says of its colours
  std::vector<std::string> warnings;        ///< each a line that names the file
};

/// Reads the map FILE or FILE:LAYER. Where no layer of an EXR is named, it is the one with red,
/// green and blue, or grey, that is called as a beauty is, in any part (channels without a layer
/// come before rgba, beauty and Combined); else the only one with red, green and blue; else the
/// only grey one.
/// Texels outside the data window are black. Texels that are not finite, negative or brighter than
/// kBrightest become black, with a warning.
/// Errors: ExitCode::input for a file that cannot be read, ExitCode::layer where no layer or more
/// than one may be the map; the message lists the candidates.
EnvironmentMap read_environment_map(const std::string& name);

}  // namespace ssdo
