// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "metrics/compare_pictures.h"

namespace ssdo {

/// null for what is not finite, which JSON does not know: nothing to be relative to, or no error.
nlohmann::json json_number(double value);

/// The figures of a pair, and what was left out.
nlohmann::json layer_json(const Compared& compared);

nlohmann::json to_json(const CompareOptions& options, const Comparison& all);

/// "only in B: a, b, c and 7 more", or nothing.
std::string list_channels(std::string_view where, const std::vector<std::string>& names);

/// "ao: 7 pixels have no counterpart (...)", or nothing.
std::string note_of_left_out(const Compared& compared);

std::string to_table(const Comparison& all);

}  // namespace ssdo
