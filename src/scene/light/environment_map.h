// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "io/pictures/primaries.h"
#include "math/plane.h"

namespace ssdo {

/// A lat-long map: as a file holds it, or made from the cube map that it holds.
struct EnvironmentMap {
  Plane<glm::vec3> texels;                  ///< linear; every channel from 0 to kBrightest
  std::string layer;                        ///< or part of an EXR; empty: channels without either
  std::optional<Chromaticities> primaries;  ///< what the file says of its colours
  std::vector<std::string> converted;       ///< how, for people
  std::vector<std::string> warnings;        ///< each a line that names the file
};

/// Reads the map FILE or FILE:LAYER. Where no layer of an EXR is named, it is the one with red,
/// green and blue, or grey, that is called as a beauty is, in any part (channels without a layer
/// come before rgba, beauty and Combined); else the only one with red, green and blue; else the
/// only grey one.
/// A map of 4096 columns or more is averaged to 2048 or somewhat more (MapReduction).
/// The sphere is the display window, and texels outside the data window are black. Where the header
/// says that it is a cube map, it is the data window, and the six faces are converted. Colours that
/// the file says are encoded become linear. Texels that are not finite or above kBrightest become
/// black, and negative channels 0, with a warning. A shape that is not two to one gets a warning.
/// Errors: ExitCode::input for a file that cannot be read, and for the shapes of six faces in a
/// row, a column or a cross; ExitCode::layer where no layer or more than one may be the map; the
/// message lists the candidates.
EnvironmentMap read_environment_map(const std::string& name);

}  // namespace ssdo
