// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "metrics/compare_shot.h"

namespace ssdo {

/// The figures of flicker; null for those that are not there.
nlohmann::json flicker_json(const FlickerFigures& figures);

nlohmann::json to_json(const CompareOptions& options, const ShotComparison& shot);

/// A line for each frame and layer, one for each layer over all frames, and the worst frame.
std::string to_table(const ShotComparison& shot);

}  // namespace ssdo
