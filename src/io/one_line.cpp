// SPDX-License-Identifier: Apache-2.0
#include "io/one_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

namespace ssdo {
namespace {

/// A character of UTF-8: its code point and its length in bytes. What is not UTF-8 is one byte of
/// no code point.
struct Character {
  char32_t code_point = 0;
  std::size_t bytes = 1;
  bool valid = false;
};

Character first_character(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  if (lead < 0x80) return {lead, 1, true};
  const auto bytes = std::size_t(std::countl_one(lead));
  if (bytes < 2 || bytes > 4 || bytes > text.size()) return {};
  char32_t code_point = lead & (0x7Fu >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    const auto next = static_cast<unsigned char>(text[i]);
    if ((next & 0xC0) != 0x80) return {};
    code_point = code_point << 6 | (next & 0x3F);
  }
  // A longer form than needed could hide a control character.
  constexpr std::array<char32_t, 3> kSmallest = {0x80, 0x800, 0x10000};
  if (code_point < kSmallest[bytes - 2] || code_point > 0x10FFFF) return {};
  return {code_point, bytes, true};
}

bool is_printable(const Character& c) {
  const auto within = [&](char32_t first, char32_t last) {
    return c.code_point >= first && c.code_point <= last;
  };
  const bool control = within(0, 0x1F) || within(0x7F, 0x9F);
  const bool ends_line = within(0x2028, 0x2029);
  const bool reorders = within(0x200E, 0x200F) || within(0x202A, 0x202E) || within(0x2066, 0x2069);
  return c.valid && !control && !ends_line && !reorders && !within(0xD800, 0xDFFF);
}

}  // namespace

std::string one_line(std::string message) {
  std::replace_if(
      message.begin(), message.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  while (!message.empty() && (message.back() == ' ' || message.back() == '.')) message.pop_back();
  return message;
}

std::string printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const Character next = first_character(text);
    const std::string_view bytes = text.substr(0, next.bytes);
    if (is_printable(next)) {
      out += bytes;
    } else {
      for (const char byte : bytes)
        out += fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
    }
    text.remove_prefix(next.bytes);
  }
  return out;
}

}  // namespace ssdo
