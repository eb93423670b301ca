// SPDX-License-Identifier: Apache-2.0
#include "io/json_text.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/run_tool.h"

namespace ssdo::test::json_text_test {
namespace {

using nlohmann::json;

TEST(JsonText, KeepsUtf8AndSpellsOtherBytes) {
  const std::vector<std::pair<std::string, std::string>> texts = {
      {"plain", "plain"},
      {"d\xC3\xA9j\xC3\xA0 \xE6\xBC\xA2 \xF0\x9F\x8C\x9E",
       "d\xC3\xA9j\xC3\xA0 \xE6\xBC\xA2 \xF0\x9F\x8C\x9E"},
      {"d\xE9j\xE0", "d\\xe9j\\xe0"},
      {"\xFF\xC3", "\\xff\\xc3"},
      {"a\xC3(", "a\\xc3("},
      {"\xC0\xAF", "\\xc0\\xaf"},           // overlong
      {"\xED\xA0\x80", "\\xed\\xa0\\x80"},  // half of a pair of UTF-16
      {"\xF5\x80\x80\x80", "\\xf5\\x80\\x80\\x80"},
  };
  for (const auto& [text, shown] : texts) {
    const json value = {{"list", {text, 1.5, nullptr}}, {text, true}};
    const json back = json::parse(json_text(value));
    EXPECT_EQ(back, json({{"list", {shown, 1.5, nullptr}}, {shown, true}})) << shown;
    EXPECT_EQ(json_text(json(text), 2), json(shown).dump(2));
  }
}

/// Issue 13 would come back with the first other way to JSON text.
TEST(JsonText, IsTheOnlyWayFromJsonToText) {
  const auto source = std::filesystem::path(SSDO_SOURCE_DIR) / "src";
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(source)) {
    const std::string name = entry.path().filename();
    if (!name.ends_with(".cpp") && !name.ends_with(".h")) continue;
    ++files;
    if (name == "json_text.cpp") continue;
    EXPECT_EQ(read_file(entry.path()).find(".dump("), std::string::npos) << entry.path();
  }
  EXPECT_GT(files, 50);
}

}  // namespace
}  // namespace ssdo::test::json_text_test
