// SPDX-License-Identifier: Apache-2.0
//
// One shot as every tool writes it gives one result; what is not sure is refused with the option
// that decides it.
#include <gmock/gmock.h>

#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "dcc/tool_cases.h"
#include "support/info_warnings.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::tools_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

std::vector<std::string> joined(std::vector<std::string> words,
                                const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

class Tools : public testing::TestWithParam<Tool> {
 protected:
  Tools() { write_shot(input_, GetParam().shot); }

  json info() const {
    const Finished done = run_tool(joined({"info", input_, "--json"}, flags_));
    EXPECT_EQ(done.code, 0) << done.err;
    return parse_json(done.out);
  }

  TempDir dir_;
  std::string input_ = dir_ / "frame.exr";
  std::vector<std::string> flags_ = flags_in(dir_.path(), GetParam());
};

std::string depth_of(const json& info) {
  const json& depth = info["depth"];
  if (depth.is_null()) return "";
  if (!depth["used"]) return "left out";
  return depth["kind"].get<std::string>() + " " + depth["source"].get<std::string>();
}

std::vector<testing::Matcher<std::string>> with_parts(const std::vector<std::string>& parts) {
  std::vector<testing::Matcher<std::string>> all;
  for (const std::string& part : parts) all.push_back(HasSubstr(part));
  return all;
}

/// Without the flags, a file is refused, or hinted at what it may hold.
TEST_P(Tools, NameTheOptionsThatDecide) {
  const Tool& tool = GetParam();
  const Finished done = run_tool({"info", input_, "--json"});
  EXPECT_EQ(done.code, tool.refusal.empty() ? 0 : 4) << done.err;
  for (const std::string& part : tool.refusal) EXPECT_THAT(done.error_line(), HasSubstr(part));
  if (done.code != 0) return;
  EXPECT_THAT(warnings_of(parse_json(done.out)),
              testing::UnorderedElementsAreArray(
                  with_parts(tool.flags.empty() ? tool.warnings : tool.hints)));
}

/// Whether the options make a frame of the file.
bool is_usable(const Tool& tool) { return tool.refusal.empty() || !tool.flags.empty(); }

TEST_P(Tools, AreRecognised) {
  const Tool& tool = GetParam();
  if (!is_usable(tool)) return;
  const json found = info();
  for (const StoredLayer& layer : tool.shot.layers) {
    if (!layer.role) continue;
    const std::string role(role_name(*layer.role));
    ASSERT_TRUE(found["layers"].contains(role)) << role;
    const json& used = found["layers"][role]["channels"];
    const std::vector<std::string> first(layer.channels.begin(),
                                         layer.channels.begin() + std::ptrdiff_t(used.size()));
    EXPECT_EQ(used.get<std::vector<std::string>>(), first);
  }
  const Found expected = tool.found;
  const json& p = found["position"];
  EXPECT_EQ(p.is_null() ? "" : p["space"], expected.space);
  if (!p.is_null()) {
    EXPECT_EQ(p["handedness"], expected.handedness);
  }
  EXPECT_EQ(found["normals"]["space"], expected.normals);
  EXPECT_EQ(depth_of(found), expected.depth);
  EXPECT_THAT(warnings_of(found), testing::UnorderedElementsAreArray(with_parts(tool.warnings)));
}

Plane<float> ao_of(const std::string& input, const std::vector<std::string>& flags) {
  TempDir dir;
  const std::string output = dir / "out.exr";
  const Finished done =
      run_tool(joined({input, "-o", output, "--products", "ao", "--pixel-type", "float", "--prior",
                       "rules"},  // files that tell no way up are asked another network
                      flags));
  EXPECT_EQ(done.code, 0) << done.err;
  return channel(output, "ao.Y");
}

Plane<float> plain_ao() {
  TempDir dir;
  write_shot(dir / "plain.exr", plain_shot());
  return ao_of(dir / "plain.exr", {});
}

TEST_P(Tools, GiveTheSameAo) {
  const Tool& tool = GetParam();
  if (!is_usable(tool)) return;
  static const Plane<float> expected = plain_ao();
  const Plane<float> found = ao_of(input_, flags_);
  const Window data = ExrReader(input_).parts()[0].data_window;
  double sum = 0;
  for (int y = 0; y < found.height; ++y) {
    for (int x = 0; x < found.width; ++x)
      sum += std::pow(double(found(x, y)) - double(expected(x + data.x0, y + data.y0)), 2);
  }
  EXPECT_LE(std::sqrt(sum / double(found.size())), tool.bound);
  RecordProperty("rmse", std::to_string(std::sqrt(sum / double(found.size()))));
}

/// A name for GoogleTest: letters and digits only.
std::string test_name(const testing::TestParamInfo<Tool>& tool) {
  std::string name;
  for (const char c : tool.param.name)
    if (std::isalnum(static_cast<unsigned char>(c))) name += c;
  return name;
}

INSTANTIATE_TEST_SUITE_P(Dcc, Tools, testing::ValuesIn(tools()), test_name);

}  // namespace
}  // namespace ssdo::test::tools_test
