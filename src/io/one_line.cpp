// SPDX-License-Identifier: Apache-2.0
#include "io/one_line.h"

#include <algorithm>

#include "io/utf8.h"

namespace ssdo {
namespace {

bool is_printable(const Character& c) {
  const auto within = [&](char32_t first, char32_t last) {
    return c.code_point >= first && c.code_point <= last;
  };
  const bool control = within(0, 0x1F) || within(0x7F, 0x9F);
  const bool ends_line = within(0x2028, 0x2029);
  const bool reorders = within(0x200E, 0x200F) || within(0x202A, 0x202E) || within(0x2066, 0x2069);
  return c.valid && !control && !ends_line && !reorders;
}

}  // namespace

std::string one_line(std::string message) {
  std::replace_if(
      message.begin(), message.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  while (!message.empty() && (message.back() == ' ' || message.back() == '.')) message.pop_back();
  return message;
}

std::string printable(std::string_view text) { return escaped(text, is_printable); }

}  // namespace ssdo
