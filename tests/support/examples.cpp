// SPDX-License-Identifier: Apache-2.0
#include "support/examples.h"

#include <regex>
#include <sstream>
#include <utility>

#include "support/run_tool.h"

namespace ssdo::test {
namespace {

std::string document(const std::string& name) {
  return read_file(std::string(SSDO_SOURCE_DIR) + "/" + name);
}

/// The lines for which `is_one` holds, without the first `indent` letters, each run of them a
/// block.
template <class IsOne>
std::vector<std::string> blocks(const std::string& text, std::size_t indent, const IsOne& is_one) {
  std::vector<std::string> found;
  bool inside = false;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const bool before = std::exchange(inside, is_one(line));
    if (!inside) continue;
    if (!before) found.emplace_back();
    found.back() += line.substr(indent) + "\n";
  }
  return found;
}

/// Commands in the text of a README that have a file, such as `ssdo in.exr -o out.exr`.
std::vector<std::string> spans(const std::string& text) {
  static const std::regex span("`((ssdo|oiiotool) [^`]*\\.exr[^`]*)`");
  std::vector<std::string> found;
  for (std::sregex_iterator it(text.begin(), text.end(), span), end; it != end; ++it)
    found.push_back(std::regex_replace((*it)[1].str(), std::regex("\n *"), " ") + "\n");
  return found;
}

/// As groff shows it.
std::string without_escapes(const std::string& text) {
  const std::string plain = std::regex_replace(text, std::regex(R"(\\-)"), "-");
  return std::regex_replace(plain, std::regex(R"(\\e)"), "\\");
}

std::vector<std::string> blocks_of_page(const std::string& text) {
  bool inside = false;
  return blocks(without_escapes(text), 0, [&](const std::string& line) {
    const bool was = inside;
    if (line == ".EX") inside = true;
    if (line == ".EE") inside = false;
    return was && inside;
  });
}

}  // namespace

std::vector<Example> examples() {
  std::vector<Example> all;
  const auto add = [&](const std::string& name, const std::vector<std::string>& texts) {
    for (const std::string& text : texts) all.push_back({name, text});
  };
  const auto is_indented = [](const std::string& line) { return line.starts_with("    "); };
  for (const char* name : {"README.md", "data/blender/README.md"}) {
    add(name, blocks(document(name), 4, is_indented));
    add(name, spans(document(name)));
  }
  for (const char* name : {"man/ssdo.1", "man/ssdo-methods.7"})
    add(name, blocks_of_page(document(name)));
  const auto is_command = [](const std::string& line) {
    return line.starts_with("  ssdo ") && line.find(".exr") != line.npos &&
           line.find("INPUT") == line.npos;
  };
  add("--help", blocks(run_tool({"--help"}).out, 2, is_command));
  return all;
}

}  // namespace ssdo::test
