// SPDX-License-Identifier: Apache-2.0
#include "cli/bench_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <set>

#include "bench/truth.h"
#include "error.h"
#include "math/number.h"

namespace ssdo {
namespace {

/// Options that bench sets itself, and those that need an output.
const std::set<std::string> kRefused = {
    "--method",     "--quality",      "--slices",        "--steps",         "--error",
    "--temporal",   "--output",       "--save",          "--pixel-type",    "--compression",
    "--bits",       "--frames",       "--keep-channels", "--skip-existing", "--on-error",
    "--crop",       "--dry-run",      "--stats",         "--shot",          "--list-methods",
    "--downsample", "--allow-partial"};

/// The options that a bench of a sequence takes: it measures one method and quality.
const std::set<std::string> kOfSequences = {"--method", "--quality", "--slices",
                                            "--steps",  "--error",   "--frames"};

/// Groups of options that change what the main job computes.
const std::set<std::string> kCarried = {"Input", "Camera", "Light", "Model"};

WantedError read_want(const std::string& text) {
  const auto equals = text.rfind('=');
  const bool named = equals != std::string::npos;
  const auto value = parse_number(named ? text.substr(equals + 1) : text);
  if (!value || *value <= 0) {
    throw Error(ExitCode::usage,
                fmt::format("--want {}: expected a positive error, or PRODUCT=ERROR", text));
  }
  return {named ? text.substr(0, equals) : "", *value};
}

/// An option as it was given: its name and one value, or its name alone.
void carry(const CLI::Option& option, BenchOptions& out) {
  if (option.get_items_expected_max() == 0) {
    out.carried.push_back({option.get_name()});
    return;
  }
  for (const std::string& value : option.results())
    out.carried.push_back({option.get_name(), value});
}

}  // namespace

CLI::App* add_bench(CLI::App& app, BenchOptions& o) {
  CLI::App* bench = app.add_subcommand("bench",
                                       "speed against error of methods and settings on this "
                                       "frame, and the setting for a wanted error; of a sequence, "
                                       "its flicker")
                        ->fallthrough();
  bench->footer(
      "It takes INPUT and options of the main job that say what is measured: ssdo --help-all");
  bench
      ->add_option("--report", o.reports,
                   "write .html (a page with charts and maps), .csv or .json; repeatable")
      ->type_name("FILE")
      ->allow_extra_args(false);
  bench
      ->add_option(
          "--truth", o.truths,
          "what a product has to be, repeatable; the layer's name tells which product: AO, "
          "DiffDir, DiffInd; else ao=FILE:LAYER")
      ->type_name("[PRODUCT=]FILE:LAYER")
      ->allow_extra_args(false);
  bench->add_option("--methods", o.methods, "those to measure; default: all")
      ->type_name("LIST")
      ->delimiter(',')
      ->allow_extra_args(false);
  bench
      ->add_option_function<std::vector<std::string>>(
          "--want",
          [&](const std::vector<std::string>& texts) {
            for (const std::string& text : texts) o.wants.push_back(read_want(text));
          },
          "name the cheapest setting whose error is this at most, repeatable; of the first "
          "product, "
          "or of the one that is named")
      ->type_name("[PRODUCT=]E")
      ->allow_extra_args(false);
  return bench;
}

bool is_refused_by_bench(const std::string& flag) { return kRefused.contains(flag); }

void finish_bench(const CLI::App& app, bool of_sequence, BenchOptions& o) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() == 0) continue;
    const std::string name = option->get_name();
    if (is_refused_by_bench(name) && !(of_sequence && kOfSequences.contains(name))) {
      throw Error(ExitCode::usage,
                  fmt::format("bench takes no {}: {}", name,
                              name == "--method" ? "name methods with --methods"
                                                 : "it tries settings and writes reports alone"));
    }
    if (kCarried.contains(option->get_group()) || name == "--frames") carry(*option, o);
  }
}

}  // namespace ssdo
