// SPDX-License-Identifier: Apache-2.0
#include "cli/help/option_completion.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>

#include "cli/bench_options.h"
#include "cli/option_values.h"
#include "estimators/registry.h"
#include "filters/registry.h"
#include "scene/layers/roles.h"

namespace ssdo {
namespace {

using Words = std::vector<std::string>;

/// The names of the rows of a table, and `more`, if not empty, as one more name.
template <class Table>
Words names_of(const Table& table, std::string_view more = "") {
  Words names;
  for (const auto& row : table) names.emplace_back(row.name);
  if (!more.empty()) names.emplace_back(more);
  return names;
}

Words roles() {
  const auto names = role_names();
  return {names.begin(), names.end()};
}

/// The options whose values have names that the help does not show as {A,B}.
const std::map<std::string, Completion>& named_values() {
  static const std::map<std::string, Completion> all = {
      {"--method", {"words", names_of(methods())}},
      {"--methods", {"list", names_of(methods())}},
      {"--set", {"parameters", {}}},
      {"--filter", {"words", names_of(filters(), kPublishedFilter)}},
      {"--products", {"list", names_of(kProducts, kAllProducts)}},
      {"--save", {"keys", names_of(kProducts)}},
      {"--aov", {"layers", roles()}},
      {"--compression", {"words", compression_names()}},
      {"--depth-kind", {"words", depth_kind_names()}},
  };
  return all;
}

Words split(const std::string& text, char at) { return CLI::detail::split(text, at); }

/// The words of a type such as "R|auto|inf" that stand for themselves.
Words literals(const std::string& type) {
  Words words = split(type, '|');
  std::erase_if(words, [](const std::string& word) {
    return !std::ranges::all_of(word, [](char c) { return c >= 'a' && c <= 'z'; });
  });
  return words;
}

/// "json" of "FILE.json", "exr" of "OUT.exr".
Words ending_of(const std::string& type) {
  const auto dot = type.rfind('.');
  return dot == type.npos ? Words{} : Words{type.substr(dot + 1)};
}

}  // namespace

Completion completion_of(const CLI::Option& option) {
  if (option.get_items_expected_max() == 0) return {"none", {}};
  const auto named = named_values().find(option.get_name());
  if (named != named_values().end()) return named->second;
  const std::string type = option.get_type_name();
  if (type.starts_with("{")) return {"words", split(type.substr(1, type.find('}') - 1), ',')};
  for (const char* file : {"FILE", "OUTPUT", "OUT.exr"}) {
    if (type.find(file) != type.npos) return {"files", ending_of(type)};
  }
  const Words words = literals(type);
  return {words.empty() ? "text" : "words", words};
}

std::vector<MethodSettings> method_settings() {
  std::vector<MethodSettings> all;
  for (const Method& method : methods()) {
    MethodSettings& row = all.emplace_back(MethodSettings{std::string(method.name), {}});
    for (const Parameter& parameter : method.parameters) {
      const std::string key = std::string(parameter.name) + "=";
      if (parameter.words.empty()) row.settings.push_back(key);
      for (const std::string& word : split(std::string(parameter.words), ' ')) {
        if (!parameter.words.empty()) row.settings.push_back(key + word);
      }
    }
  }
  return all;
}

std::vector<const CLI::Option*> options_with(const CLI::App& app, const CLI::App& command) {
  const auto is_option = [](const CLI::Option* option) { return option->nonpositional(); };
  std::vector<const CLI::Option*> options = command.get_options(is_option);
  if (!command.get_fallthrough()) return options;
  for (const CLI::Option* option : app.get_options(is_option)) {
    const std::string name = option->get_name();
    const bool refused = command.get_name() == "bench" && is_refused_by_bench(name);
    if (!refused && !command.get_option_no_throw(name)) options.push_back(option);
  }
  return options;
}

}  // namespace ssdo
