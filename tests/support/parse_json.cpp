// SPDX-License-Identifier: Apache-2.0
#include "support/parse_json.h"

namespace ssdo::test {

nlohmann::json parse_json(const std::string& text) { return nlohmann::json::parse(text); }

}  // namespace ssdo::test
