// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace ssdo::test {

/// The value that a JSON text stands for, compiled once for all tests. Throws
/// nlohmann::json::parse_error.
nlohmann::json parse_json(const std::string& text);

}  // namespace ssdo::test
