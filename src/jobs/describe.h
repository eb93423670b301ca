// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "relight/frame.h"

namespace ssdo {

/// What was found in a frame and decided for it: as text for people, and as JSON for programs.
std::string describe(const Frame& frame);
nlohmann::json to_json(const Frame& frame);

}  // namespace ssdo
