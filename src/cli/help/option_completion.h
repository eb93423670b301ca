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

/// How the value of an option is completed. The scripts know the kinds by these names.
struct Completion {
  std::string_view
      kind;  ///< none: takes no value; words; list: of words, by commas; keys: WORD=FILE;
             ///< parameters: of the method; files; text: only the user knows it
  std::vector<std::string> words;  ///< of files: their ending, or nothing for any file
};

/// Of the value of this option.
Completion completion_of(const CLI::Option& option);

/// What --set takes with a method: "NAME=", or "NAME=WORD" for each word of a parameter.
struct MethodSettings {
  std::string method;
  std::vector<std::string> settings;
};

/// Of every method; the first is the default.
std::vector<MethodSettings> method_settings();

/// The options that can stand on the line of a command; of the main job where it is `app` itself.
/// Without words that belong to no option.
std::vector<const CLI::Option*> options_with(const CLI::App& app, const CLI::App& command);

}  // namespace ssdo
