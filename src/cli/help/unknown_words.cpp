// SPDX-License-Identifier: Apache-2.0
#include "cli/help/unknown_words.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <vector>

#include "nearest_name.h"

namespace ssdo {
namespace {

using Names = std::vector<std::string>;

Error usage(const std::string& message) { return {ExitCode::usage, message}; }

/// The command of the line; null: the main job.
const CLI::App* command_of(const CLI::App& app) {
  const auto parsed = app.get_subcommands();
  return parsed.empty() ? nullptr : parsed.front();
}

/// The command that prints the options which go with `command`.
std::string help_of(const CLI::App* command) {
  return command ? fmt::format("ssdo {} --help", command->get_name()) : "ssdo --help";
}

/// Long names, without dashes: as many letters as a user has to spell.
Names option_names(const CLI::App& app) {
  Names names;
  for (const CLI::Option* option : app.get_options())
    names.insert(names.end(), option->get_lnames().begin(), option->get_lnames().end());
  return names;
}

/// The options that go with the command.
Names options_of(const CLI::App& app, const CLI::App* command) {
  if (!command) return option_names(app);
  Names names = option_names(*command);
  if (command->get_fallthrough()) {
    const Names more = option_names(app);
    names.insert(names.end(), more.begin(), more.end());
  }
  return names;
}

Error unknown_option(const CLI::App& app, const std::string& word) {
  const CLI::App* const command = command_of(app);
  const std::string flag = word.substr(0, word.find('='));
  if (flag == "--neighbours")
    return usage(
        "--neighbours: is now --shot, which takes what the frames around have found; "
        "frames of a still set can be given with --also");
  for (const CLI::App* other : app.get_subcommands({})) {
    if (!command && other->get_option_no_throw(flag))
      return usage(fmt::format("{0}: is an option of ssdo {1}; see ssdo {1} --help", flag,
                               other->get_name()));
  }
  if (command && app.get_option_no_throw(flag))
    return usage(
        fmt::format("{} takes no {}; see {}", command->get_name(), flag, help_of(command)));
  const std::string name = flag.substr(std::min(flag.find_first_not_of('-'), flag.size()));
  const auto meant = nearest_name(name, options_of(app, command));
  return usage(fmt::format("{}: no such option; {}see {}", flag,
                           meant ? fmt::format("did you mean --{}? ", *meant) : "",
                           help_of(command)));
}

}  // namespace

std::optional<std::string> misspelt_command(const CLI::App& app) {
  const CLI::Option& input = *app.get_option("INPUT");
  if (command_of(app) || input.count() == 0) return std::nullopt;
  Names commands;
  for (const CLI::App* command : app.get_subcommands({})) commands.push_back(command->get_name());
  return nearest_name(input.results().front(), commands);
}

Error unknown_words(const CLI::App& app) {
  if (const auto command = misspelt_command(app)) {
    return usage(fmt::format("{}: no such command; did you mean ssdo {}? see ssdo --help",
                             app.get_option("INPUT")->results().front(), *command));
  }
  const Names words = app.remaining(true);
  const auto option = std::find_if(words.begin(), words.end(),
                                   [](const std::string& word) { return word.starts_with("-"); });
  if (option != words.end()) return unknown_option(app, *option);
  const CLI::App* const command = command_of(app);
  const bool reads_a_frame = !command || command->get_fallthrough();
  return usage(fmt::format("'{}' is not expected after {}; see {}",
                           words.empty() ? "" : words.front(), reads_a_frame ? "INPUT" : "A and B",
                           help_of(command)));
}

}  // namespace ssdo
