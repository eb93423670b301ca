// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace ssdo {

/// A character of UTF-8: its code point and its length in bytes. What is not UTF-8 is one byte
/// without a code point.
struct Character {
  char32_t code_point = 0;
  std::size_t bytes = 1;
  bool valid = false;
};

/// `text` with every byte of the characters that `keep` refuses written as \xHH.
std::string escaped(std::string_view text, bool (*keep)(const Character&));

}  // namespace ssdo
