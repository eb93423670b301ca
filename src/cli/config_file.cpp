// SPDX-License-Identifier: Apache-2.0
#include "cli/config_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <set>
#include <vector>

#include "error.h"
#include "io/one_line.h"
#include "io/size_guard.h"
#include "nearest_name.h"

namespace ssdo {
namespace {

std::string_view name_of(toml::node_type type) {
  switch (type) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::string:
      return "a string";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "a boolean";
    default:
      return "a date or time";
  }
}

/// Gives options their values from one file.
class ConfigFile {
 public:
  ConfigFile(const std::string& path, CLI::App& app) : path_(path), app_(app) {
    for (const CLI::Option* option : app.get_options()) {
      if (option->count() > 0) on_command_line_.insert(option);
    }
  }

  void read() {
    const toml::table table = parse();
    for (const auto& [key, value] : table) set(std::string(key.str()), value, line_of(key));
  }

 private:
  /// Every option takes less than 10 KiB; toml++ recurses into tables, and has the stack for this.
  static constexpr std::size_t kMostBytes = 64 << 10;

  [[noreturn]] void fail(std::uint32_t line, const std::string& what) const {
    throw Error(ExitCode::usage, fmt::format("{}:{}: {}", path_, line, one_line(what)));
  }

  static std::uint32_t line_of(const toml::key& key) { return key.source().begin.line; }

  toml::table parse() const {
    std::ifstream in(path_, std::ios::binary);
    in.peek();  // a folder can be opened, but not read
    if (in.bad() || !in.is_open()) {
      throw Error(ExitCode::usage,
                  fmt::format("{}: config file cannot be read; check --config", path_));
    }
    const std::string text = read_text(in, path_, kMostBytes, ExitCode::usage);
    try {
      return toml::parse(text, path_);
    } catch (const toml::parse_error& e) {
      fail(e.source().begin.line, fmt::format("not TOML: {}", e.description()));
    }
  }

  void set(const std::string& key, const toml::node& value, std::uint32_t line) const {
    if (value.is_table()) {
      fail(line, fmt::format("{}: is a table; options stand at the top level, by their long names "
                             "without dashes in front",
                             key));
    }
    CLI::Option& option = find(key, line);
    const std::vector<std::string> texts = texts_of(option, key, value, line);
    if (texts.empty() || on_command_line_.contains(&option)) return;
    for (const CLI::Option* other : option.get_excludes()) {
      if (on_command_line_.contains(other)) return;
      if (other->count() > 0)
        fail(line, fmt::format("{}: excludes {}, which stands here too", key, other->get_name()));
    }
    try {
      for (const std::string& text : texts) option.add_result(text);
      option.run_callback();
    } catch (const CLI::ParseError& e) {
      fail(line, e.what());
    } catch (const Error& e) {
      fail(line, e.what());
    }
  }

  /// The keys that a file may have.
  std::vector<std::string> keys() const {
    std::vector<std::string> names;
    for (const CLI::Option* option : app_.get_options()) {
      if (option->get_configurable())
        names.insert(names.end(), option->get_lnames().begin(), option->get_lnames().end());
    }
    return names;
  }

  CLI::Option& find(const std::string& key, std::uint32_t line) const {
    const std::string flag = "--" + key;
    CLI::Option* option = app_.get_option_no_throw(flag);
    if (option && option->get_configurable()) return *option;
    if (option) fail(line, fmt::format("{}: can be given on the command line only", key));
    for (const CLI::App* command : app_.get_subcommands({})) {
      if (command->get_option_no_throw(flag)) {
        fail(line, fmt::format("{}: is an option of ssdo {}; give it on the command line", key,
                               command->get_name()));
      }
    }
    fail(line, fmt::format("'{}' is no option; {}keys are the long names of the main job's options "
                           "without dashes in front, see ssdo --help-all",
                           key, did_you_mean(key, keys())));
  }

  /// The value as text of the command line; nothing for a flag that is false.
  std::vector<std::string> texts_of(const CLI::Option& option, const std::string& key,
                                    const toml::node& value, std::uint32_t line) const {
    if (option.get_items_expected_max() == 0) {
      if (!value.is_boolean())
        fail(line, fmt::format("{}: expected true or false, found {}", key, name_of(value.type())));
      return value.value_or(false) ? std::vector<std::string>{"true"} : std::vector<std::string>{};
    }
    const toml::array* list = value.as_array();
    if (!list) return {text_of(key, value, line)};
    if (option.get_items_expected_max() == 1)
      fail(line, fmt::format("{}: takes one value, found an array", key));
    std::vector<std::string> texts;
    for (const toml::node& element : *list)
      texts.push_back(text_of(key, element, element.source().begin.line));
    return texts;
  }

  std::string text_of(const std::string& key, const toml::node& value, std::uint32_t line) const {
    if (const auto* text = value.as_string()) {
      if (text->get().empty())
        fail(line, fmt::format("{}: has an empty value; leave it out instead", key));
      return text->get();
    }
    if (const auto* number = value.as_integer()) return fmt::format("{}", number->get());
    if (const auto* number = value.as_floating_point()) return fmt::format("{}", number->get());
    fail(line,
         fmt::format("{}: expected a string or a number, found {}", key, name_of(value.type())));
  }

  const std::string& path_;
  CLI::App& app_;
  std::set<const CLI::Option*> on_command_line_;
};

}  // namespace

void read_config_file(const std::string& path, CLI::App& app) { ConfigFile(path, app).read(); }

}  // namespace ssdo
