// SPDX-License-Identifier: Apache-2.0
#include "io/json_text.h"

#include <nlohmann/json.hpp>
#include <string_view>

#include "io/utf8.h"

namespace ssdo {
namespace {

using nlohmann::json;

std::string as_utf8(std::string_view text) {
  return escaped(text, [](const Character& c) { return c.valid; });
}

json as_utf8(const json& value) {
  if (value.is_string()) return as_utf8(std::string_view(value.get_ref<const std::string&>()));
  if (!value.is_structured()) return value;
  json out = value.is_array() ? json::array() : json::object();
  for (const auto& [key, element] : value.items()) {
    if (value.is_array()) {
      out.push_back(as_utf8(element));
    } else {
      out[as_utf8(std::string_view(key))] = as_utf8(element);
    }
  }
  return out;
}

}  // namespace

std::string json_text(const json& value, int indent) { return as_utf8(value).dump(indent); }

}  // namespace ssdo
