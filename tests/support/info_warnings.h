// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace ssdo::test {

/// What `ssdo info --json` warns of in a file, without the advice on what to render beside it, and
/// without a word about an albedo that nothing in it is like.
inline std::vector<std::string> warnings_of(const nlohmann::json& info) {
  auto warnings = info["warnings"].get<std::vector<std::string>>();
  std::erase_if(warnings, [](const std::string& text) {
    return text.find("directions are guessed") != std::string::npos ||
           text.find("; name one with --aov albedo=LAYER") != std::string::npos;
  });
  return warnings;
}

}  // namespace ssdo::test
