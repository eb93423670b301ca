// SPDX-License-Identifier: Apache-2.0
#include "io/utf8.h"

#include <gtest/gtest.h>

namespace ssdo::test::utf8_test {
namespace {

bool is_valid(const Character& c) { return c.valid; }

TEST(Utf8, KeepsCharactersOfEveryLength) {
  const std::string text = "a\xC3\xA9\xE2\x82\xAC\xF0\x9F\x99\x82";
  EXPECT_EQ(escaped(text, is_valid), text);
}

TEST(Utf8, EscapesBytesThatAreNoCharacter) {
  EXPECT_EQ(escaped("\xE9t\xE9", is_valid), "\\xe9t\\xe9") << "Latin-1";
  EXPECT_EQ(escaped("\xE2\x82", is_valid), "\\xe2\\x82") << "cut short";
  EXPECT_EQ(escaped("\x80", is_valid), "\\x80") << "the middle of a character";
  EXPECT_EQ(escaped("\xC0\xAF", is_valid), "\\xc0\\xaf") << "longer than needed";
  EXPECT_EQ(escaped("\xED\xA0\x80", is_valid), "\\xed\\xa0\\x80") << "half of a UTF-16 pair";
  EXPECT_EQ(escaped("\xF4\x90\x80\x80", is_valid), "\\xf4\\x90\\x80\\x80") << "beyond U+10FFFF";
}

TEST(Utf8, TellsTheCodePointToTheCaller) {
  const auto no_euro = [](const Character& c) { return c.code_point != 0x20AC; };
  EXPECT_EQ(escaped("5 \xE2\x82\xAC", no_euro), "5 \\xe2\\x82\\xac");
}

}  // namespace
}  // namespace ssdo::test::utf8_test
