// SPDX-License-Identifier: Apache-2.0
#include "io/json_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

namespace ssdo {
namespace {

using nlohmann::json;

/// Length of the character at the start of `text` (Unicode 15, table 3-7), 0 where there is none.
std::size_t character_length(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
  };
  const auto follows = [&](std::size_t i, unsigned low = 0x80, unsigned high = 0xBF) {
    return byte(i) >= low && byte(i) <= high;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return follows(1) ? 2 : 0;
  if (first >= 0xE0 && first <= 0xEF) {
    // No overlong forms, and no halves of pairs of UTF-16.
    const unsigned low = first == 0xE0 ? 0xA0 : 0x80, high = first == 0xED ? 0x9F : 0xBF;
    return follows(1, low, high) && follows(2) ? 3 : 0;
  }
  if (first >= 0xF0 && first <= 0xF4) {
    const unsigned low = first == 0xF0 ? 0x90 : 0x80, high = first == 0xF4 ? 0x8F : 0xBF;
    return follows(1, low, high) && follows(2) && follows(3) ? 4 : 0;
  }
  return 0;
}

std::string as_utf8(std::string_view text) {
  std::string out;
  std::size_t copied = 0;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = character_length(text.substr(i));
    if (length == 0) {
      out += text.substr(copied, i - copied);
      out += fmt::format("\\x{:02X}", static_cast<unsigned char>(text[i]));
      copied = i + 1;
    }
    i += std::max<std::size_t>(length, 1);
  }
  return out += text.substr(copied);
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
