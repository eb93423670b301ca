// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "scene/light/light.h"

namespace ssdo {

/// The name of the environment among the lights: its sky, and the suns that were taken out of it.
inline constexpr std::string_view kEnvironmentName = "env";

/// A part of a frame's light that may have layers of its own: the environment or a lamp.
struct LightGroup {
  std::string name;  ///< of its layers
  Light light;       ///< as if it were the only one
  std::vector<std::size_t>
      source_indices;  ///< indices of its sources in Light::sources of all lights
};

/// The lights of a frame, whose sum is `all`: the environment, unless it is a colour of 0 beside
/// lamps, then the lamps in their order.
std::vector<LightGroup> light_groups_of(const Light& all);

/// Whether some of the light comes from lamps.
bool has_lamps(const Light& all);

/// All of them as one light without a name.
LightGroup as_one_group(const Light& all);

}  // namespace ssdo
