// SPDX-License-Identifier: Apache-2.0
#include "cli/parse_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <set>
#include <sstream>

#include "cli/bench_options.h"
#include "cli/config_file.h"
#include "cli/help/completions.h"
#include "cli/help/short_help.h"
#include "cli/help/unknown_words.h"
#include "cli/made_by.h"
#include "cli/main_options.h"
#include "cli/option_values.h"
#include "error.h"
#include "io/one_line.h"
#include "io/sequence.h"
#include "relight/ineffective_options.h"

namespace ssdo {
namespace {

CLI::App* add_compare(CLI::App& app, CompareOptions& o) {
  CLI::App* compare =
      app.add_subcommand("compare",
                         "error between two images or sequences, layer by layer: FILE or "
                         "FILE:LAYER; flicker of sequences");
  compare->add_option("A", o.a, "image or layer to measure; a sequence: relit.####.exr")
      ->required();
  compare->add_option("B", o.b, "image or layer to hold it to; not needed with --points");
  compare->add_option("--mask", o.mask, "compare only pixels where this is not 0")
      ->type_name("FILE[:LAYER]");
  compare->add_option("--diff", o.diff, "write A - B")->type_name("OUT.exr");
  compare->add_option("--fail-above", o.fail_above, "exit with 1 if the RMSE of a layer is above")
      ->type_name("RMSE")
      ->check(between(0, 1e38));
  compare
      ->add_option("--max-invalid", o.max_invalid,
                   "share of pixels that may be valid in one image only under --fail-above")
      ->type_name("SHARE")
      ->capture_default_str()
      ->check(between(0, 1));
  compare
      ->add_option_function<std::string>(
          "--frames", [&o](const std::string& text) { o.frames = parse_frames(text); },
          "frames of sequences: 1001-1010,1020-1030x2; default: all that exist")
      ->type_name("RANGE");
  compare
      ->add_option("--points", o.points,
                   "measure flicker, the change at the same points of these G-buffers' surfaces")
      ->type_name("FILE.####.exr");
  compare
      ->add_option("--camera", o.camera,
                   "their camera as JSON; without it, fitted from P or read from the header")
      ->type_name("FILE.json");
  compare->add_flag("--json", o.json, "as JSON");
  compare->add_flag("--overwrite", o.policy.overwrite, "replace the output of --diff");
  compare->add_flag("--create-dirs", o.policy.create_dirs, "make its folder");
  return compare;
}

CLI::App* add_info(CLI::App& app, Options& o) {
  CLI::App* info =
      app.add_subcommand("info", "say what was found, what would be done and why; write nothing")
          ->fallthrough();
  info->footer("It takes INPUT and the options of the main job: ssdo --help-all");
  info->add_flag("--json", o.verbosity.json, "as JSON");
  return info;
}

/// Refuses empty values, which unset variables of scripts leave.
void refuse_empty_values(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_items_expected_max() == 0) continue;
    for (const std::string& value : option->results()) {
      if (value.empty()) {
        throw Error(ExitCode::usage, fmt::format("{}: its value is empty; give one or leave it out",
                                                 option->get_name()));
      }
    }
  }
}

std::set<std::string> names_given(const CLI::App& app) {
  std::set<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() > 0) names.insert(option->get_name());
  }
  return names;
}

/// `compare` reads no frame, so no option of the main job applies to it.
void refuse_options_of_the_main_job(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() > 0) {
      throw Error(ExitCode::usage,
                  fmt::format("compare takes no {}; see ssdo compare --help", option->get_name()));
    }
  }
}

/// Refuses a main job without input or output.
void check(const Options& o, const CLI::App& app) {
  if (o.input_file.empty()) throw Error(ExitCode::usage, "no INPUT given; see ssdo --help");
  if (o.input.views.size() > 1 && !o.camera.file.empty()) {
    throw Error(ExitCode::usage,
                fmt::format("--camera {}: has the pose of one eye; give --stereo left, then right",
                            o.camera.file));
  }
  if (o.command == Command::relight && o.output.files.empty() && o.output.saves.empty() &&
      !o.verbosity.dry_run) {
    if (misspelt_command(app)) throw unknown_words(app);
    throw Error(ExitCode::usage,
                fmt::format("{}: no output given; name one with -o OUTPUT", o.input_file));
  }
}

/// Breaks long lines between words; what follows is indented as the text that it goes on with.
std::string wrap(const std::string& text) {
  constexpr std::size_t kColumns = 100;
  std::string out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = std::min(line.find_first_not_of(' '), line.size());
    const std::size_t gap = line.find("  ", first);  // between an option and its text
    const std::size_t indent = gap == line.npos ? first : line.find_first_not_of(' ', gap);
    while (line.size() > kColumns) {
      const std::size_t blank = line.rfind(' ', kColumns);
      if (blank == line.npos || blank <= indent) break;
      out += line.substr(0, blank) + "\n";
      line = std::string(indent, ' ') + line.substr(blank + 1);
    }
    out += line + "\n";
  }
  return out;
}

}  // namespace

ParsedOptions parse_options(int argc, const char* const* argv) {
  ParsedOptions parsed;
  Options& o = parsed.options;
  CLI::App app{
      "Puts light back into a rendered frame: occlusion, environment light and bounces from a "
      "G-buffer.",
      "ssdo"};
  app.set_help_flag("-h,--help", "print the most needed options, and exit");
  app.set_help_all_flag("--help-all", "print all options, and exit");
  app.set_version_flag("--version", std::string("ssdo ") + SSDO_VERSION,
                       "print the version, and exit")
      ->configurable(false);
  std::string shell;
  app.add_option("--completions", shell, "print the completion script of this shell, and exit")
      ->type_name(kShells)
      ->configurable(false);
  app.add_option("INPUT", o.input_file, "multilayer EXR, or a sequence: shot.####.exr")
      ->type_name("");
  bool list = false;
  app.add_flag("--list-methods", list, "print the methods, their products and parameters")
      ->configurable(false)
      ->group("Model");
  add_main_options(app, o);
  bool history = false;
  app.add_flag("--history", history, "add user, host and command line to the header of EXR outputs")
      ->group("Output");
  app.require_subcommand(0, 1);
  const CLI::App* const info = add_info(app, o);
  const CLI::App* const bench = add_bench(app, o.bench);
  const CLI::App* const compare = add_compare(app, o.compare);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForAllHelp&) {
    parsed.print =
        wrap(app.get_formatter()->make_help(&app, app.get_name(), CLI::AppFormatMode::All));
    return parsed;
  } catch (const CLI::CallForHelp&) {
    parsed.print = app.get_subcommands().empty() ? std::string(kShortHelp) : wrap(app.help());
    return parsed;
  } catch (const CLI::CallForVersion&) {
    parsed.print = std::string("ssdo ") + SSDO_VERSION + "\n";
    return parsed;
  } catch (const CLI::ExtrasError&) {
    throw unknown_words(app);
  } catch (const CLI::ParseError& e) {
    throw Error(ExitCode::usage, one_line(e.what()) + "; see ssdo --help");
  }
  refuse_empty_values(app);
  for (const CLI::App* command : app.get_subcommands()) refuse_empty_values(*command);
  if (!shell.empty()) {
    parsed.print = completions(app, shell);
    return parsed;
  }
  if (list) {
    o.command = Command::list_methods;
    return parsed;
  }
  if (compare->parsed()) {
    o.command = Command::compare;
    refuse_options_of_the_main_job(app);
    return parsed;
  }
  if (info->parsed()) {
    o.command = Command::info;
    o.input.listed = true;
  }
  if (bench->parsed()) o.command = Command::bench;
  const std::set<std::string> given = names_given(app);
  if (!o.config_file.empty()) read_config_file(o.config_file, app);
  const bool of_sequence = o.command == Command::bench && is_pattern(o.input_file);
  if (o.command == Command::bench) finish_bench(app, of_sequence, o.bench);
  check(o, app);
  if (history) o.output.made_by = made_by({argv, std::size_t(argc)});
  const Purpose purpose = o.command == Command::relight                 ? Purpose::relight
                          : o.command == Command::bench && !of_sequence ? Purpose::bench
                                                                        : Purpose::other;
  o.warnings = ineffective_options(given, o, purpose);
  return parsed;
}

}  // namespace ssdo
