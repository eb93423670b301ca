// SPDX-License-Identifier: Apache-2.0
//
// Each script is tables that are made here, and functions that read them: completion.sh, .bash and
// .zsh beside this file.
#include "cli/help/completions.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>

#include "cli/help/option_completion.h"
#include "error.h"
#include "nearest_name.h"

namespace ssdo {
namespace {

using Texts = std::vector<std::string>;

constexpr std::string_view kSharedFunctions =
#include "completion_sh.inc"
    ;
constexpr std::string_view kBashFunctions =
#include "completion_bash.inc"
    ;
constexpr std::string_view kZshFunctions =
#include "completion_zsh.inc"
    ;

/// "-o" and "--output".
Texts spellings(const CLI::Option& option) {
  Texts names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

/// A shell function that looks up the name it is given; `rows`: a pattern, and words to print.
std::string lookup(const std::string& function,
                   const std::vector<std::pair<std::string, Texts>>& rows) {
  std::string text = fmt::format("{}() {{\n  case $1 in\n", function);
  for (const auto& [pattern, words] : rows)
    text += fmt::format("    {}) echo '{}' ;;\n", pattern, fmt::join(words, " "));
  return text + "  esac\n}\n\n";
}

/// Calls visit(pattern of its name, command) for every command, and last for the main job.
template <class Visit>
void for_each_command(const CLI::App& app, const Visit& visit) {
  for (const CLI::App* command : app.get_subcommands({})) visit(command->get_name(), *command);
  visit("*", app);
}

Texts commands_of(const CLI::App& app) {
  Texts names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

std::string settings_table() {
  std::vector<std::pair<std::string, Texts>> rows;
  for (const MethodSettings& row : method_settings()) rows.push_back({row.method, row.settings});
  rows[0].first += "|''";
  return lookup("_ssdo_settings", rows);
}

// ---- bash

/// A bash function that looks up the options of a command, or of the main job.
std::string bash_options(const CLI::App& app) {
  std::vector<std::pair<std::string, Texts>> rows;
  for_each_command(app, [&](const std::string& pattern, const CLI::App& command) {
    Texts flags;
    for (const CLI::Option* option : options_with(app, command)) {
      for (const std::string& name : spellings(*option)) flags.push_back(name);
    }
    rows.push_back({pattern, flags});
  });
  return lookup("_ssdo_options", rows);
}

/// Kind and words of the value of each option that takes one.
std::string bash_values(const CLI::App& app) {
  std::vector<std::pair<std::string, Texts>> rows;
  for_each_command(app, [&](const std::string&, const CLI::App& command) {
    for (const CLI::Option* option : command.get_options()) {
      const Completion value = completion_of(*option);
      if (!option->nonpositional() || value.kind == "none") continue;
      Texts row = {std::string(value.kind)};
      row.insert(row.end(), value.words.begin(), value.words.end());
      rows.push_back({fmt::format("{}", fmt::join(spellings(*option), "|")), row});
    }
  });
  return lookup("_ssdo_value", rows);
}

std::string bash_script(const CLI::App& app) {
  return "# Completion of bash for ssdo, from: ssdo --completions bash\n\n" +
         lookup("_ssdo_commands", {{"*", commands_of(app)}}) + bash_options(app) +
         bash_values(app) + settings_table() + std::string(kSharedFunctions) +
         std::string(kBashFunctions);
}

// ---- zsh

/// The text with a backslash before each of `letters`, for a place in single quotes.
std::string escaped(std::string_view text, std::string_view letters) {
  std::string out;
  for (const char c : text) {
    if (letters.find(c) != letters.npos) out += '\\';
    out += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return out;
}

/// What _arguments does for a value.
std::string zsh_action(const Completion& value) {
  const std::string words = fmt::format("{}", fmt::join(value.words, " "));
  if (value.kind == "words") return fmt::format("({})", words);
  if (value.kind == "list") return fmt::format("_values -s , name {}", words);
  if (value.kind == "keys") return fmt::format(" _ssdo_keys {}", words);
  if (value.kind == "layers") return fmt::format(" _ssdo_role {}", words);
  if (value.kind == "parameters") return " _ssdo_parameters";
  if (value.kind == "files")
    return words.empty() ? "_files" : fmt::format("_files -g \"*.{}(-.)\"", words);
  return " ";
}

/// The arguments of _arguments for an option.
std::string zsh_specs(const CLI::Option& option) {
  const Completion value = completion_of(option);
  const bool takes_value = value.kind != "none";
  const bool repeatable = option.get_expected_max() > 1;
  const std::string& description = option.get_description();
  std::string rest =
      fmt::format("[{}]", escaped(description.substr(0, description.find('\n')), "\\[]"));
  if (takes_value)
    rest += fmt::format(":{}:{}", escaped(option.get_type_name(), "\\:"), zsh_action(value));
  std::string text;
  for (const std::string& name : spellings(option)) {
    const bool is_long = name.starts_with("--");
    text += fmt::format("        '{}{}{}{}'\n", repeatable ? "*" : "", name,
                        takes_value && is_long ? "=" : "", rest);
  }
  return text;
}

/// A function that sets the array `specs` to what _arguments takes for each command.
std::string zsh_options(const CLI::App& app) {
  std::string text = "_ssdo_specs() {\n  case $1 in\n";
  for_each_command(app, [&](const std::string& pattern, const CLI::App& command) {
    text += fmt::format("    {})\n      specs=(\n", pattern);
    for (const CLI::Option* option : options_with(app, command)) text += zsh_specs(*option);
    text += "      ) ;;\n";
  });
  return text + "  esac\n}\n\n";
}

/// A function that sets the array `names` to the commands and what they do.
std::string zsh_commands(const CLI::App& app) {
  std::string text = "_ssdo_commands() {\n  names=(\n";
  for (const CLI::App* command : app.get_subcommands({})) {
    text += fmt::format("    '{}:{}'\n", command->get_name(),
                        escaped(command->get_description(), "\\:"));
  }
  return text + "  )\n}\n\n";
}

std::string zsh_script(const CLI::App& app) {
  return "#compdef ssdo\n# Completion of zsh for ssdo, from: ssdo --completions zsh\n\n" +
         zsh_commands(app) + zsh_options(app) + settings_table() + std::string(kSharedFunctions) +
         std::string(kZshFunctions);
}

}  // namespace

std::string completions(const CLI::App& app, const std::string& shell) {
  if (shell == "bash") return bash_script(app);
  if (shell == "zsh") return zsh_script(app);
  throw Error(ExitCode::usage, fmt::format("--completions {}: {}expected one of bash, zsh", shell,
                                           did_you_mean(shell, {"bash", "zsh"})));
}

}  // namespace ssdo
