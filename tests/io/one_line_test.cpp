// SPDX-License-Identifier: Apache-2.0
#include "io/one_line.h"

#include <gtest/gtest.h>

namespace ssdo::test::one_line_test {
namespace {

// Issue 12, number 20: control characters of names.
TEST(Printable, KeepsTextAndEscapesTheRest) {
  for (const std::string text : {"", "plain 'text' \\ 100%", "é 漢字 😀", "a\xC2\xA0z"})
    EXPECT_EQ(printable(text), text);
  EXPECT_EQ(printable("a\033[2Jb\nc\rd\te\x7f"), "a\\x1b[2Jb\\x0ac\\x0dd\\x09e\\x7f");
  EXPECT_EQ(printable(std::string_view("\0x", 2)), "\\x00x");
  EXPECT_EQ(printable("\xC2\x9B"), "\\xc2\\x9b") << "a control character of 8 bits";
  EXPECT_EQ(printable("\xE2\x80\xAE"), "\\xe2\\x80\\xae") << "right to left";
  EXPECT_EQ(printable("\xE2\x80\xA8"), "\\xe2\\x80\\xa8") << "line separator";
}

TEST(Printable, EscapesWhatIsNotUtf8) {
  EXPECT_EQ(printable("caf\xE9.exr"), "caf\\xe9.exr") << "Latin-1";
  EXPECT_EQ(printable("\x9B\xFF\x80"), "\\x9b\\xff\\x80");
  EXPECT_EQ(printable("\xC0\x9B"), "\\xc0\\x9b") << "longer than needed";
  EXPECT_EQ(printable("\xE0\x80\x9B"), "\\xe0\\x80\\x9b");
  EXPECT_EQ(printable("\xED\xA0\x80"), "\\xed\\xa0\\x80") << "a surrogate";
  EXPECT_EQ(printable("\xF4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "beyond Unicode";
  EXPECT_EQ(printable("\xE6\xBC"), "\\xe6\\xbc") << "cut short";
}

}  // namespace
}  // namespace ssdo::test::one_line_test
