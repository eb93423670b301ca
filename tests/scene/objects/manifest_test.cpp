// SPDX-License-Identifier: Apache-2.0
#include "scene/objects/manifest.h"

#include <gtest/gtest.h>

#include <fstream>

#include "support/error_matchers.h"
#include "support/temp_dir.h"

namespace ssdo::test::manifest_test {
namespace {

std::map<std::string, std::uint32_t> read(const std::string& text) {
  return read_manifest({"Crypto", text, "", "", ""}, "a.exr");
}

TEST(Manifest, ReadsNamesAndIds) {
  const auto ids = read(R"({"ball":"645d3bc4","left wall":"CCFE5A6A","":"0","\u00e9":"1"})");
  EXPECT_EQ(ids.size(), 4u);
  EXPECT_EQ(ids.at("ball"), 0x645d3bc4u);
  EXPECT_EQ(ids.at("left wall"), 0xccfe5a6au);
  EXPECT_EQ(ids.at("\xc3\xa9"), 1u);
  EXPECT_TRUE(read("{}").empty());
  EXPECT_TRUE(read("").empty());
}

TEST(Manifest, IsInAFileBesideThePicture) {
  const TempDir dir;
  std::ofstream(dir / "names.json") << R"({"a":"10"})";
  const auto from = [&](const std::string& file) {
    return read_manifest({"Crypto", "", file, "", ""}, dir / "a.exr");
  };
  EXPECT_EQ(from("names.json").at("a"), 16u);
  for (const char* file : {"no.json", ".", "..", "/dev/null", "names.json/x"})
    EXPECT_THAT(error_of([&] { from(file); }), IsError(ExitCode::input, "cannot be read")) << file;
  std::ofstream(dir / "cut.json") << R"({"a":"10")";
  EXPECT_THAT(error_of([&] { from("cut.json"); }), IsError(ExitCode::input, "not JSON"));
}

/// Each is one line that says what is wrong.
TEST(Manifest, RefusesOthersInOneLine) {
  const std::string deep(100000, '[');
  const std::pair<std::string, const char*> cases[] = {
      {"{", "not JSON"},
      {R"({"a")", "not JSON"},
      {R"({"a":)", "not JSON"},
      {R"({"a":"1")", "not JSON"},
      {R"({"a":"1",})", "not JSON"},
      {R"({"a":"1"}{)", "not JSON"},
      {R"({"a":"1"} x)", "not JSON"},
      {R"({a:"1"})", "not JSON"},
      {R"({'a':'1'})", "not JSON"},
      {"{\"a\":\"1\n\"}", "not JSON"},
      {"{\"a\xff\":\"1\"}", "not JSON"},
      {"{\"\\ud800\":\"1\"}", "not JSON"},
      {std::string("{\"a\":\"1\0\"}", 10), "not JSON"},
      {"\xef\xbb", "not JSON"},
      {deep, "not JSON"},
      {" ", "not JSON"},
      {"ball=645d3bc4", "not JSON"},
      {"<xml/>", "not JSON"},
      {"NaN", "not JSON"},
      {"null", "is null"},
      {"true", "is boolean"},
      {"1", "is number"},
      {"\"a\"", "is string"},
      {"[]", "is array"},
      {R"([{"a":"1"}])", "is array"},
      {R"({"a":1})", "'a' an id"},
      {R"({"a":null})", "'a' an id"},
      {R"({"a":[]})", "'a' an id"},
      {R"({"a":["1"]})", "'a' an id"},
      {R"({"a":{}})", "'a' an id"},
      {R"({"a":{"b":"1"}})", "'a' an id"},
      {R"({"a":""})", "'a' an id"},
      {R"({"a":"xyz"})", "'a' an id"},
      {R"({"a":"0x12"})", "'a' an id"},
      {R"({"a":"12 "})", "'a' an id"},
      {R"({"a":" 12"})", "'a' an id"},
      {R"({"a":"-1"})", "'a' an id"},
      {R"({"a":"1.5"})", "'a' an id"},
      {R"({"a":"123456789"})", "'a' an id"},
      {R"({"a":"1","b":"12g"})", "'b' an id"},
      {R"({"a":"1","a":"2"})", "'a' twice"},
      {R"({"a":"1","a":"1"})", "'a' twice"},
      {R"({"a\n\u202e":"1","a\n\u202e":"2"})", "twice"},
  };
  EXPECT_GE(std::size(cases), 40u);
  for (const auto& [text, says] : cases) {
    const Error error = error_of([&, text = text] { read(text); });
    EXPECT_THAT(error, IsError(ExitCode::input, says)) << text.substr(0, 40);
    EXPECT_THAT(error, IsError(ExitCode::input, "a.exr: Cryptomatte 'Crypto'"));
    EXPECT_LT(std::string(error.what()).size(), 400u);
  }
}

}  // namespace
}  // namespace ssdo::test::manifest_test
