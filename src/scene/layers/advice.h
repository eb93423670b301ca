// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "scene/layers/groups.h"
#include "scene/layers/roles.h"

namespace ssdo {

/// Which option names the position, normal or albedo of a file that has none by name, if the name
/// of one layer suggests that it is one; else empty.
std::string hint_at(Role role, const std::vector<LayerGroup>& groups);

/// What to say for a file that has no position and no depth by name: the option that names one,
/// with the layers whose channels would fit.
std::string advice_on_position(const std::vector<LayerGroup>& groups);

}  // namespace ssdo
