// SPDX-License-Identifier: Apache-2.0
//
// Includes point down: light transport knows the scene, mathematics and threads, never files,
// options or the flow of the tool.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>

namespace ssdo::test {
namespace {

namespace fs = std::filesystem;

const fs::path kSource = fs::path(SSDO_SOURCE_DIR) / "src";

/// Adds what `file` includes with quotes, and what that includes.
void add_includes(const fs::path& file, std::set<std::string>& seen) {
  static const std::regex include("^#include \"([^\"]+)\"");
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::smatch match;
    if (!std::regex_search(line, match, include)) continue;
    if (seen.insert(match[1]).second) add_includes(kSource / match[1].str(), seen);
  }
}

TEST(Structure, LightTransportKnowsNothingAboveTheScene) {
  int files = 0;
  for (const char* folder : {"estimators", "filters", "math", "parallel"}) {
    for (const auto& entry : fs::directory_iterator(kSource / folder)) {
      std::set<std::string> seen;
      add_includes(entry.path(), seen);
      ++files;
      for (const std::string& name : seen) {
        const bool below = name.starts_with("estimators/") || name.starts_with("scene/") ||
                           name.starts_with("math/") || name.starts_with("parallel/") ||
                           name.starts_with("filters/") || name == "error.h";
        EXPECT_TRUE(below) << entry.path() << " includes " << name;
      }
    }
  }
  EXPECT_GT(files, 10);
}

}  // namespace
}  // namespace ssdo::test
