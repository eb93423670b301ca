// SPDX-License-Identifier: Apache-2.0
//
// Includes point down: main, cli, bench, the flow of a frame, stages, and below them mathematics,
// lanes and threads. Light transport never sees a file or an option.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace ssdo::test {
namespace {

namespace fs = std::filesystem;

const fs::path kSource = fs::path(SSDO_SOURCE_DIR) / "src";

/// What the files of a folder, with all that is in it, may include. "flow" stands for the files
/// right in src/ that lead a frame through the stages.
const std::map<std::string, std::set<std::string>> kBelow = {
    {"math", {}},
    {"simd", {"math"}},
    {"parallel", {"math"}},
    {"io", {"math", "parallel"}},
    {"metrics", {"math"}},
    {"scene", {"io", "math", "simd", "parallel"}},
    {"estimators", {"scene", "math", "simd", "parallel"}},
    {"filters", {"estimators", "scene", "math", "simd", "parallel"}},
    {"color", {"estimators", "scene", "io", "math", "parallel"}},
    {"flow",
     {"filters", "estimators", "scene", "color", "io", "metrics", "math", "simd", "parallel"}},
    {"bench",
     {"flow", "filters", "estimators", "scene", "color", "io", "metrics", "math", "parallel"}},
    {"cli",
     {"bench", "flow", "filters", "estimators", "scene", "color", "io", "metrics", "math", "simd",
      "parallel"}},
    {"main", {"cli", "bench", "flow", "estimators", "io"}},
};

/// What every folder may include.
const std::set<std::string> kEverywhere = {"error.h", "nearest_name.h", "stopwatch.h"};

/// Libraries whose headers stay in some folders.
const std::vector<std::pair<std::regex, std::set<std::string>>> kLibraries = {
    {std::regex("^<(Imf|Iex|OpenEXR)"), {"io", "color"}},
    {std::regex("^<OpenImageIO"), {"io", "color", "bench"}},
    {std::regex("^<OpenColorIO"), {"color"}},
    {std::regex("^<CLI/"), {"cli"}},
    {std::regex("^<embree"), {"estimators"}},
    {std::regex("^<toml"), {"cli"}},
};

/// Libraries that are slow to compile stay out of headers.
const std::regex kNotInHeaders("^<(CLI/|nlohmann/json.hpp|Eigen/|toml|OpenImageIO|embree)");

std::string folder_of(const std::string& path) {
  const auto slash = path.find('/');
  if (slash != std::string::npos) return path.substr(0, slash);
  return path.starts_with("main.") ? "main" : "flow";
}

/// What `file` includes, as it is written: <...> or "...".
std::vector<std::string> includes_of(const fs::path& file) {
  static const std::regex include(R"(^#include ([<"][^>"]+[>"]))");
  std::vector<std::string> found;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::smatch match;
    if (std::regex_search(line, match, include)) found.push_back(match[1]);
  }
  return found;
}

/// Calls visit(path relative to src, what it includes) for every source file.
template <class Visit>
int for_each_file(const Visit& visit) {
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(kSource)) {
    const std::string ending = entry.path().extension();
    if (ending != ".h" && ending != ".cpp") continue;
    visit(fs::relative(entry.path(), kSource).string(), includes_of(entry.path()));
    ++files;
  }
  return files;
}

std::string unquoted(const std::string& include) { return include.substr(1, include.size() - 2); }

/// Adds the files of the project that `file` includes, and what those include.
void add_includes(const fs::path& file, std::set<std::string>& seen) {
  for (const std::string& include : includes_of(file)) {
    if (include[0] != '"') continue;
    if (seen.insert(unquoted(include)).second) add_includes(kSource / unquoted(include), seen);
  }
}

TEST(Structure, IncludesPointDown) {
  const int files = for_each_file([](const std::string& path, const auto& includes) {
    const std::string folder = folder_of(path);
    ASSERT_TRUE(kBelow.contains(folder)) << path << ": give the folder a row in kBelow";
    for (const std::string& include : includes) {
      if (include[0] != '"' || include.ends_with(".inc\"")) continue;
      const std::string name = unquoted(include), other = folder_of(name);
      EXPECT_TRUE(other == folder || kEverywhere.contains(name) ||
                  kBelow.at(folder).contains(other))
          << path << " includes " << name;
    }
  });
  EXPECT_GT(files, 200);
}

TEST(Structure, NoFolderIncludesOneThatIncludesIt) {
  for (const auto& [folder, below] : kBelow) {
    std::set<std::string> reached = below;
    for (bool grown = true; grown;) {
      grown = false;
      for (const std::string& name : std::set<std::string>(reached))
        for (const std::string& next : kBelow.at(name)) grown |= reached.insert(next).second;
    }
    EXPECT_FALSE(reached.contains(folder)) << folder;
  }
}

TEST(Structure, LightTransportSeesNoFiles) {
  for_each_file([](const std::string& path, const auto&) {
    const std::string folder = folder_of(path);
    if (folder != "estimators" && folder != "filters") return;
    std::set<std::string> seen;
    add_includes(kSource / path, seen);
    for (const std::string& name : seen)
      EXPECT_FALSE(name.starts_with("io/") || name.starts_with("color/")) << path << ": " << name;
  });
}

TEST(Structure, LibrariesStayInTheirFolders) {
  for_each_file([](const std::string& path, const auto& includes) {
    for (const std::string& include : includes) {
      for (const auto& [library, folders] : kLibraries) {
        if (!std::regex_search(include, library)) continue;
        EXPECT_TRUE(folders.contains(folder_of(path))) << path << " includes " << include;
      }
      const bool slow = std::regex_search(include, kNotInHeaders);
      EXPECT_FALSE(slow && path.ends_with(".h")) << path << " includes " << include;
    }
  });
}

TEST(Structure, FilesAndFoldersStaySmall) {
  constexpr int kMostLines = 400, kMostModules = 22;
  std::map<fs::path, std::set<std::string>> modules;
  for_each_file([&](const std::string& path, const auto&) {
    const fs::path file = kSource / path;
    modules[file.parent_path()].insert(file.stem());
    std::ifstream in(file);
    int lines = 0;
    for (std::string line; std::getline(in, line);) ++lines;
    EXPECT_LE(lines, kMostLines) << path;
  });
  for (const auto& [folder, names] : modules)
    EXPECT_LE(names.size(), std::size_t(kMostModules)) << folder;
}

}  // namespace
}  // namespace ssdo::test
