// SPDX-License-Identifier: Apache-2.0
//
// Includes point down: main, cli, bench, many frames, the flow of one frame, its stages, and below
// them mathematics, lanes and threads. Light transport never sees a file or an option. No two files
// need each other, at any depth.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace ssdo::test::structure_test {
namespace {

namespace fs = std::filesystem;

const fs::path kSource = fs::path(SSDO_SOURCE_DIR) / "src";

/// What the files of a folder, with all that is in it, may include.
const std::map<std::string, std::set<std::string>> kBelow = {
    {"base", {}},
    {"math", {}},
    {"simd", {"math"}},
    {"parallel", {"math"}},
    {"io", {"math", "parallel"}},
    {"metrics", {"scene", "io", "math", "parallel"}},
    {"scene", {"io", "math", "simd", "parallel"}},
    {"estimators", {"scene", "math", "simd", "parallel"}},
    {"filters", {"estimators", "scene", "math", "simd", "parallel"}},
    {"prior", {"filters", "estimators", "scene", "math", "simd", "parallel"}},
    {"color", {"estimators", "scene", "io", "math", "parallel"}},
    {"plan", {"prior", "filters", "estimators", "scene", "color", "io", "math"}},
    {"relight",
     {"plan", "prior", "filters", "estimators", "scene", "color", "io", "math", "simd",
      "parallel"}},
    {"jobs",
     {"relight", "plan", "filters", "estimators", "scene", "color", "io", "math", "simd",
      "parallel"}},
    {"bench",
     {"jobs", "relight", "plan", "filters", "estimators", "scene", "color", "io", "metrics", "math",
      "parallel"}},
    {"cli",
     {"bench", "jobs", "relight", "plan", "filters", "estimators", "scene", "color", "io",
      "metrics", "math", "simd", "parallel"}},
    {"main", {"cli", "bench", "jobs", "metrics", "estimators", "io"}},
};

/// Libraries whose headers stay in some folders.
const std::vector<std::pair<std::regex, std::set<std::string>>> kLibraries = {
    {std::regex("^<(Imf|Iex|OpenEXR)"), {"io", "color"}},
    {std::regex("^<OpenImageIO"), {"io", "color", "bench"}},
    {std::regex("^<OpenColorIO"), {"color"}},
    {std::regex("^<CLI/"), {"cli"}},
    {std::regex("^<embree"), {"estimators"}},
    {std::regex("^<toml"), {"cli"}},
};

/// Libraries that are slow to compile stay out of headers, but for the one that has Embree.
const std::regex kNotInHeaders(
    "^(<(CLI/|nlohmann/json.hpp|Eigen/|toml|OpenImageIO|embree)|\"(estimators/embree|scene/camera/"
    "eigen).h)");

/// The folder in src/ that a file is in; of those right in it, "main", or "base" of what every
/// folder may include.
std::string folder_of(const std::string& path) {
  const auto slash = path.find('/');
  if (slash != path.npos) return path.substr(0, slash);
  return path.starts_with("main.") ? "main" : "base";
}

/// The files of one module: NAME.h, NAME-inl.h and NAME.cpp.
std::string module_of(const std::string& path) {
  const std::string stem = path.substr(0, path.rfind('.'));
  return stem.ends_with("-inl") ? stem.substr(0, stem.size() - 4) : stem;
}

/// The folders of two files below the innermost one that holds both; nothing where a file is right
/// in that.
std::optional<std::pair<std::string, std::string>> siblings_of(const std::string& a,
                                                               const std::string& b) {
  const auto end = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  const std::size_t common = a.substr(0, std::size_t(end.first - a.begin())).rfind('/') + 1;
  const std::size_t in_a = a.find('/', common), in_b = b.find('/', common);
  if (in_a == a.npos || in_b == b.npos) return std::nullopt;
  return std::pair(a.substr(0, in_a), b.substr(0, in_b));
}

using Graph = std::map<std::string, std::set<std::string>>;

/// What can be reached from `from`, by one step or more.
std::set<std::string> reached(const Graph& graph, const std::string& from) {
  std::set<std::string> all;
  std::vector<std::string> ahead = {from};
  while (!ahead.empty()) {
    const auto next = graph.find(ahead.back());
    ahead.pop_back();
    if (next == graph.end()) continue;
    for (const std::string& name : next->second)
      if (all.insert(name).second) ahead.push_back(name);
  }
  return all;
}

void expect_no_cycle(const Graph& graph) {
  for (const auto& [name, included] : graph)
    EXPECT_FALSE(reached(graph, name).contains(name))
        << name << " includes itself by way of others";
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
      EXPECT_TRUE(other == folder || other == "base" || kBelow.at(folder).contains(other))
          << path << " includes " << name;
    }
  });
  EXPECT_GT(files, 200);
}

TEST(Structure, NoFolderIncludesOneThatIncludesIt) { expect_no_cycle(kBelow); }

TEST(Structure, NoTwoFilesNeedEachOther) {
  Graph modules, folders;
  for_each_file([&](const std::string& path, const auto& includes) {
    for (const std::string& include : includes) {
      if (include[0] != '"' || include.ends_with(".inc\"")) continue;
      const std::string name = unquoted(include);
      if (module_of(name) != module_of(path)) modules[module_of(path)].insert(module_of(name));
      const auto beside = siblings_of(path, name);
      if (beside && beside->first != beside->second) folders[beside->first].insert(beside->second);
    }
  });
  EXPECT_GT(modules.size(), 100u);
  EXPECT_GT(folders.size(), 20u);
  expect_no_cycle(modules);
  expect_no_cycle(folders);
}

TEST(Structure, LightTransportSeesNoFiles) {
  for_each_file([](const std::string& path, const auto&) {
    const std::string folder = folder_of(path);
    if (folder != "estimators" && folder != "filters" && folder != "prior") return;
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
      EXPECT_FALSE(slow && path.ends_with(".h") && path != "estimators/embree.h" &&
                   path != "scene/camera/eigen.h")
          << path << " includes " << include;
    }
  });
}

TEST(Structure, OneTableDecidesWhichOptionsHaveNoEffect) {
  for_each_file([](const std::string& path, const auto&) {
    if (fs::path(path).stem() == "ineffective_options") return;
    std::ifstream in(kSource / path);
    for (std::string line; std::getline(in, line);)
      EXPECT_EQ(line.find("has no effect:"), line.npos) << path << ": " << line;
  });
}

/// Of two classes of one name, a program has the functions of either. Headers for vectors have a
/// namespace of their own.
TEST(Structure, EachTypeHasANameOfItsOwn) {
  const std::regex definition(R"(^(?:class|struct|enum class) (\w+)[^;]*\{)");
  std::map<std::pair<bool, std::string>, std::string> homes;
  for_each_file([&](const std::string& path, const auto&) {
    if (!path.ends_with(".h")) return;
    std::ifstream in(kSource / path);
    for (std::string line; std::getline(in, line);) {
      std::smatch name;
      if (!std::regex_search(line, name, definition)) continue;
      const auto [home, is_first] =
          homes.try_emplace({path.ends_with("-inl.h"), name[1].str()}, path);
      EXPECT_TRUE(is_first || home->second == path)
          << name[1] << " stands in " << home->second << " and in " << path;
    }
  });
  EXPECT_GT(homes.size(), 300u);
}

TEST(Structure, FilesAndFoldersStaySmall) {
  constexpr int kMostLines = 400, kMostModules = 22, kMostOnTop = 12;
  std::map<fs::path, std::set<std::string>> modules;
  for_each_file([&](const std::string& path, const auto&) {
    const fs::path file = kSource / path;
    modules[file.parent_path()].insert(file.stem());
    std::ifstream in(file);
    int lines = 0;
    for (std::string line; std::getline(in, line);) ++lines;
    EXPECT_LE(lines, kMostLines) << path;
  });
  EXPECT_LE(modules.at(kSource).size(), std::size_t(kMostOnTop));
  for (const auto& [folder, names] : modules)
    EXPECT_LE(names.size(), std::size_t(kMostModules)) << folder;
}

}  // namespace
}  // namespace ssdo::test::structure_test
