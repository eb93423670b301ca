// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace ssdo {

// What can be completed, whatever the shell.

/// How the value of an option is completed. `kind` is what the scripts call it:
/// none: there is no value; text: only the user knows it; words: one of the words; list: some of
/// them, by commas; keys: WORD=FILE; layers: the same, or WORD=LAYER of INPUT; parameters: of the
/// method; files: with the ending that `words` holds, or all.
struct Completion {
  std::string_view kind;
  std::vector<std::string> words;
};

/// How the value of this option is completed.
Completion completion_of(const CLI::Option& option);

/// What --set takes with a method: "NAME=", or "NAME=WORD" for each word of a parameter.
struct MethodSettings {
  std::string method;
  std::vector<std::string> settings;
};

/// The settings of every method; the first method is the default.
std::vector<MethodSettings> method_settings();

/// The options that can stand on the line of a command; of the main job where it is `app` itself.
/// Without words that belong to no option.
std::vector<const CLI::Option*> options_with(const CLI::App& app, const CLI::App& command);

}  // namespace ssdo
