// SPDX-License-Identifier: Apache-2.0
#include "bench/command.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "io/one_line.h"

namespace ssdo {
namespace {

/// Whether the setting's method takes an option as it was given.
bool reaches(const std::vector<std::string>& option, const Setting& setting) {
  const SupportedOptions& supports = setting.method->supports;
  if (option[0] == "--thickness") return supports.thickness;
  if (option[0] != "--radius") return true;
  return option.back() == "inf" ? supports.infinite_radius : supports.radius;
}

}  // namespace

std::string shell_word(const std::string& word) {
  const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
    return (c < 128 && std::isalnum(c)) ||
           std::string_view("_./:=,+@%-").find(char(c)) != std::string_view::npos;
  });
  if (plain) return word;
  if (printable(word) != word) {
    std::string escaped;
    for (const char c : word)
      escaped += c == '\'' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
    return "$'" + printable(escaped) + "'";
  }
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string command_of(const BenchJob& job, const Setting& setting, const Plan& plan) {
  std::vector<std::string> words = {"ssdo", job.input};
  for (const auto& option : job.options.carried) {
    if (reaches(option, setting)) words.insert(words.end(), option.begin(), option.end());
  }
  const auto own = setting.arguments();
  words.insert(words.end(), own.begin(), own.end());
  const std::string stem = std::filesystem::path(job.input).stem().string();
  words.insert(words.end(), {"--products", fmt::format("{}", fmt::join(plan.make, ",")), "-o",
                             stem + "_relit.exr"});
  for (std::string& word : words) word = shell_word(word);
  return fmt::format("{}", fmt::join(words, " "));
}

}  // namespace ssdo
