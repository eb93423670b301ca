// SPDX-License-Identifier: Apache-2.0
#include "io/utf8.h"

#include <fmt/format.h>

#include <array>
#include <bit>

namespace ssdo {
namespace {

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
  // A longer form than needed could hide a control character; halves of UTF-16's pairs are none.
  constexpr std::array<char32_t, 3> kSmallest = {0x80, 0x800, 0x10000};
  const bool half_of_pair = code_point >= 0xD800 && code_point <= 0xDFFF;
  if (code_point < kSmallest[bytes - 2] || code_point > 0x10FFFF || half_of_pair) return {};
  return {code_point, bytes, true};
}

}  // namespace

std::string escaped(std::string_view text, bool (*keep)(const Character&)) {
  std::string out;
  while (!text.empty()) {
    const Character next = first_character(text);
    const std::string_view bytes = text.substr(0, next.bytes);
    if (keep(next)) {
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
