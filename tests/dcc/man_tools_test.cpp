// SPDX-License-Identifier: Apache-2.0
//
// The section TOOLS of the man page is what the table of tools says and what is recognised.
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>

#include "dcc/tool_cases.h"
#include "support/parse_json.h"
#include "support/run_tool.h"

namespace ssdo::test::man_tools_test {
namespace {

using nlohmann::json;

const std::string kPage = std::string(SSDO_SOURCE_DIR) + "/man/ssdo.1";

constexpr const char *kBegin = ".\\\" The list of tools begins: SSDO_WRITE_TABLES=1 writes it.\n",
                     *kEnd = ".\\\" The list of tools ends.\n";

std::string in_groff(const std::string& text) {
  return std::regex_replace(std::regex_replace(text, std::regex("-"), "\\-"), std::regex("\""),
                            "\\(dq");
}

/// A layer as the man page names it: a depth, or what has no name, by its channels.
std::string name_of(const json& layer) {
  const auto channels = layer["channels"].get<std::vector<std::string>>();
  if (channels.size() > 1 && layer["layer"] != "") return layer["layer"];
  return fmt::format("{}", fmt::join(channels, " "));
}

/// "name LAYER (remark)," on a line; nothing for a role that is not there.
std::string item(const json& info, Role role, const std::string& name, const std::string& remark) {
  const auto layer = info["layers"].find(std::string(role_name(role)));
  if (layer == info["layers"].end()) return "";
  return fmt::format("{} \\fI{}\\fR{},\n", name, in_groff(name_of(*layer)),
                     remark.empty() ? "" : " (" + in_groff(remark) + ")");
}

std::string remark_on_position(const json& position) {
  if (position.is_null()) return "";
  const bool camera = position["space"] == "camera", left = position["handedness"] == "left";
  return fmt::format("{}{}{}", camera ? "camera space" : "", camera && left ? ", " : "",
                     left ? "left-handed" : "");
}

std::string remark_on_depth(const json& depth) {
  if (depth.is_null()) return "";
  if (!depth["used"]) return "left out";
  return depth["kind"] == "ray" ? "along the rays" : "";
}

std::string remark_on_normals(const std::string& space) {
  return space == "the space of P" ? "" : space;
}

/// What the user gives, each option with its value; a value with a space in quotes.
std::string options_of(const Tool& tool) {
  std::vector<std::string> options;
  for (std::size_t i = 0; i + 1 < tool.flags.size(); i += 2) {
    const std::string value = std::regex_replace(tool.flags[i + 1], std::regex("DIR/"), "");
    const bool quoted = value.find(' ') != std::string::npos;
    options.push_back(fmt::format("{0} {2}{1}{2}", tool.flags[i], value, quoted ? "\"" : ""));
  }
  return in_groff(fmt::format("{}", fmt::join(options, " ")));
}

std::string entry(const Tool& tool) {
  TempDir dir;
  write_shot(dir / "frame.exr", tool.shot);
  std::vector<std::string> words = {"info", dir / "frame.exr", "--json"};
  const std::vector<std::string> flags = flags_in(dir.path(), tool);
  words.insert(words.end(), flags.begin(), flags.end());
  const json info = parse_json(run_tool(words).out);
  const std::string head = ".TP\n.B " + in_groff(tool.name) + "\n";
  if (info.contains("error")) return head + "Not enough: it has neither P nor depth.\n";
  std::string text = item(info, Role::position, "P", remark_on_position(info["position"])) +
                     item(info, Role::normal, "N", remark_on_normals(info["normals"]["space"])) +
                     item(info, Role::albedo, "albedo", "") +
                     item(info, Role::depth, "depth", remark_on_depth(info["depth"]));
  text.replace(text.size() - 2, 1, ".");
  if (!tool.flags.empty()) text += "Give\n.BR \"" + options_of(tool) + "\" .\n";
  if (!tool.note.empty()) text += in_groff(tool.note) + "\n";
  return head + text;
}

TEST(ManPageOfTools, IsWhatIsRecognised) {
  std::string expected;
  for (const Tool& tool : tools()) expected += entry(tool);
  std::string page = read_file(kPage);
  const auto begin = page.find(kBegin), end = page.find(kEnd);
  ASSERT_NE(begin, std::string::npos);
  ASSERT_NE(end, std::string::npos);
  const auto from = begin + std::string(kBegin).size();
  const std::string found = page.substr(from, end - from);
  if (found != expected && std::getenv("SSDO_WRITE_TABLES")) {
    std::ofstream(kPage) << page.replace(from, end - from, expected);
    return;
  }
  EXPECT_EQ(found, expected) << "run this test with SSDO_WRITE_TABLES=1 to write the section anew";
}

}  // namespace
}  // namespace ssdo::test::man_tools_test
