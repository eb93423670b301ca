// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/layers/roles.h"

namespace ssdo {

/// The text in lower case.
std::string lower(std::string_view text);

/// A layer's path as names are compared: in lower case, without spaces, underscores and dashes.
std::string normalise(std::string_view text);

/// The place of the first name known for the role that one of the keys matches; smaller is better.
std::optional<std::size_t> rank_of(Role role, const std::vector<std::string>& keys);

}  // namespace ssdo
