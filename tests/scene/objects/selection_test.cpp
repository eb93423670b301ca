// SPDX-License-Identifier: Apache-2.0
#include "scene/objects/selection.h"

#include <gtest/gtest.h>

#include <fstream>

#include "support/error_matchers.h"
#include "support/temp_dir.h"

namespace ssdo::test::selection_test {
namespace {

/// "+crypto:a -id:L=1,5-7 +matte:f.exr|L".
std::string parsed(const std::string& text) {
  std::string out;
  for (const SelectionTerm& term : parse_selection("--only", text).terms) {
    out += out.empty() ? "" : " ";
    out += term.adds ? "+" : "-";
    if (!term.file.empty()) out += term.file + "|";
    switch (term.kind) {
      case SelectionTerm::Kind::cryptomatte:
        out += "crypto:" + term.name;
        break;
      case SelectionTerm::Kind::matte:
        out += "matte:" + term.layer;
        break;
      case SelectionTerm::Kind::ids:
        out += "id:" + term.layer;
        for (const auto& [first, last] : term.ids)
          out += "=" + std::to_string(first) + ".." + std::to_string(last);
    }
  }
  return out;
}

TEST(Selection, ReadsTerms) {
  EXPECT_EQ(parsed("crypto:ball"), "+crypto:ball");
  EXPECT_EQ(parsed("crypto:left wall"), "+crypto:left wall");
  EXPECT_EQ(parsed("crypto:*.00[12]"), "+crypto:*.00[12]");
  EXPECT_EQ(parsed("crypto:ns:ball"), "+crypto:ns:ball");
  EXPECT_EQ(parsed("id:IndexOB=1,5-7, 9"), "+id:IndexOB=1..1=5..7=9..9");
  EXPECT_EQ(parsed("id:IndexOB=-3--1"), "+id:IndexOB=-3..-1");
  EXPECT_EQ(parsed("matte.A"), "+matte:matte.A");
  EXPECT_EQ(parsed(" matte "), "+matte:matte");
}

TEST(Selection, JoinsThem) {
  EXPECT_EQ(parsed("crypto:a+crypto:b-crypto:c"), "+crypto:a +crypto:b -crypto:c");
  EXPECT_EQ(parsed("crypto:a + matte"), "+crypto:a +matte:matte");
  EXPECT_EQ(parsed("crypto:a - matte"), "+crypto:a -matte:matte");
  EXPECT_EQ(parsed("matte-id:L=2-3-crypto:x"), "+matte:matte -id:L=2..3 -crypto:x");
  EXPECT_EQ(parsed("id:L=2-3 - matte"), "+id:L=2..3 -matte:matte");
  EXPECT_EQ(parsed("a+b"), "+matte:a +matte:b");
}

/// Names have dashes; a plus needs quotes.
TEST(Selection, LeavesNamesWhole) {
  EXPECT_EQ(parsed("crypto:my-box"), "+crypto:my-box");
  EXPECT_EQ(parsed("my-matte-2.A"), "+matte:my-matte-2.A");
  EXPECT_EQ(parsed("crypto:\"a + b - c\"-crypto:d"), "+crypto:a + b - c -crypto:d");
  EXPECT_EQ(parsed("crypto:-x"), "+crypto:-x");
}

TEST(Selection, TellsAFileByItsExistence) {
  const TempDir dir;
  const std::string file = dir / "m.exr";
  std::ofstream(file) << "x";
  EXPECT_EQ(parsed(file + ":L"), "+" + file + "|matte:L");
  EXPECT_EQ(parsed("crypto:" + file + ":a:b"), "+" + file + "|crypto:a:b");
  EXPECT_EQ(parsed("id:" + file + ":L=1"), "+" + file + "|id:L=1..1");
  EXPECT_EQ(parsed("nothere.exr:L"), "+matte:nothere.exr:L");
  const std::string pattern = dir / "m.####.exr";
  EXPECT_EQ(parsed(pattern + ":L"), "+" + pattern + "|matte:L");
  const Selection shot = parse_selection("--only", pattern + ":L+crypto:a#");
  EXPECT_EQ(at_frame(shot, 7).terms[0].file, dir / "m.0007.exr");
  EXPECT_EQ(at_frame(shot, 7).terms[1].name, "a#");
}

TEST(Selection, RefusesWhatIsNone) {
  for (const char* text :
       {"", " ", "crypto:", "id:", "id:L", "id:L=", "id:L=a", "id:L=1,", "id:L=7-5", "id:=1",
        "id:L=1-2-3", "id:L=99999999999999999999", "crypto:a+", "crypto:a - ", "a++b", "\"\"",
        "crypto:a+crypto:", "id:L=1.5", "id:L=0x1"}) {
    const Error error = error_of([&] { parse_selection("--only", text); });
    EXPECT_THAT(error, IsError(ExitCode::usage, "--only")) << text;
  }
  // A text that no file's name can be is a name.
  EXPECT_EQ(parse_selection("--only", std::string(5000, 'a') + ":b").terms.size(), 1u);
}

}  // namespace
}  // namespace ssdo::test::selection_test
