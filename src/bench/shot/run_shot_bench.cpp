// SPDX-License-Identifier: Apache-2.0
#include "bench/shot/run_shot_bench.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "bench/command.h"
#include "bench/machine.h"
#include "bench/report_files.h"
#include "bench/shot/measure_shot.h"
#include "bench/shot/shot_report.h"
#include "io/json_text.h"
#include "io/one_line.h"
#include "io/pictures/picture_layers.h"
#include "io/sequence.h"
#include "io/standard_output.h"
#include "jobs/jobs.h"
#include "jobs/progress.h"
#include "jobs/sequence/sequence_frames.h"
#include "nearest_name.h"
#include "stopwatch.h"

namespace ssdo {
namespace {

void check_options(const RunOptions& options, const BenchOptions& bench) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ExitCode::usage, fmt::format("{}: is a sequence: {}", options.input_file, what));
  };
  if (!bench.methods.empty()) refuse("name one method with --method, in place of --methods");
  if (!bench.wants.empty()) refuse("--want chooses a setting for a single frame");
  if (options.input.views.size() > 1)
    refuse("bench measures one view; give --stereo left or right");
}

std::vector<int> frames_of(const RunOptions& options) {
  std::vector<int> frames =
      options.batch.frames ? *options.batch.frames : find_frames(options.input_file);
  if (frames.empty())
    throw Error(ExitCode::input,
                fmt::format("{}: no frame of this sequence exists", options.input_file));
  return frames;
}

/// The frames for which a truth exists.
std::vector<int> frames_with(const std::string& picture, const std::vector<int>& frames) {
  std::vector<int> there;
  std::error_code ignored;
  for (const int frame : frames)
    if (std::filesystem::exists(expand_pattern(parse_picture_name(picture).file, frame), ignored))
      there.push_back(frame);
  return there;
}

/// Finds the products of the truths, and reads one frame of each.
void find_truths(const std::vector<std::string>& texts, ShotSubject& subject,
                 std::map<std::string, ShotTruth>& truths) {
  for (const std::string& text : texts) {
    TruthRequest request = parse_truth(text);
    const PictureName name = parse_picture_name(request.picture);
    if (!is_pattern(name.file))
      throw Error(ExitCode::usage,
                  fmt::format("--truth {}: the input is a sequence; give the truth a frame pattern "
                              "too, such as truth.####.exr",
                              text));
    ShotTruth truth{request.picture, frames_with(request.picture, subject.frames)};
    if (truth.frames.empty())
      throw Error(ExitCode::input, fmt::format("--truth {}: none of the {} frames exists", text,
                                               subject.frames.size()));
    const std::string file = expand_pattern(name.file, truth.frames.front());
    request.product =
        read_truth({request.product, name.layer.empty() ? file : file + ":" + name.layer}).product;
    if (!truths.emplace(request.product, std::move(truth)).second)
      throw Error(ExitCode::usage, fmt::format("--truth {}: there is another truth of {} already",
                                               text, request.product));
    subject.truths[request.product] = request;
  }
}

/// The first frame, as the main job sees it.
Frame first_frame(const ShotSubject& subject) {
  RunOptions options = subject.options;
  options.output.products.clear();
  options.output.compose.reset();
  const Lighting light(options.light);
  OtherPictures pictures(options.input.allow_partial, options.input.objects);
  SequenceFrames frames(options, pictures);
  const int number = subject.frames.front();
  return frames.prepare(light, files_at(options, number), number);
}

/// The products asked for, or by default those that mean something here; and those with a truth.
std::vector<std::string> products_of(const ShotSubject& subject, const Frame& frame) {
  const std::vector<std::string>& asked = subject.options.output.products;
  for (const std::string& name : asked) {
    if (!contains(measured_products(), name))
      throw Error(ExitCode::usage, fmt::format("product '{}': {}bench measures {}", name,
                                               did_you_mean(name, measured_products()),
                                               fmt::join(measured_products(), ", ")));
  }
  std::vector<std::string> products;
  for (const std::string& name : measured_products()) {
    const bool usual =
        name == "direct" ? !frame.scene.light.is_constant() : contains(frame.plan.make, name);
    if (contains(asked, name) || subject.truths.contains(name) || (asked.empty() && usual))
      products.push_back(name);
  }
  return products;
}

std::string command_of(const ShotSubject& subject, const BenchOptions& bench,
                       const ShotSetting& setting) {
  std::vector<std::string> words = {"ssdo", subject.options.input_file};
  for (const auto& option : bench.carried) words.insert(words.end(), option.begin(), option.end());
  words.insert(words.end(), setting.arguments.begin(), setting.arguments.end());
  words.insert(words.end(), {"--products", fmt::format("{}", fmt::join(subject.products, ",")),
                             "-o", "relit.####.exr"});
  for (std::string& word : words) word = shell_word(word);
  return fmt::format("{}", fmt::join(words, " "));
}

void check_files(const ShotSubject& subject, const BenchOptions& bench,
                 const std::map<std::string, ShotTruth>& truths) {
  std::vector<RunFile> inputs;
  for (const int frame : subject.frames) {
    for (RunFile& file : inputs_of(subject.options, files_at(subject.options, frame)))
      inputs.push_back(std::move(file));
    for (const auto& [product, truth] : truths)
      inputs.push_back({"--truth", expand_pattern(parse_picture_name(truth.picture).file, frame)});
  }
  check_report_files(bench.reports, std::move(inputs), subject.options.output.policy);
}

}  // namespace

ExitCode run_shot_bench(const RunOptions& options, const BenchOptions& bench,
                        const Resources& resources) {
  Stopwatch watch;
  check_options(options, bench);
  ShotSubject subject{options, resources, frames_of(options), {}, {}};
  ShotBenchReport report;
  find_truths(bench.truths, subject, report.truths);
  check_files(subject, bench, report.truths);
  {
    const Frame frame = first_frame(subject);
    subject.products = products_of(subject, frame);
    report.width = frame.scene.geometry.display.width();
    report.height = frame.scene.geometry.display.height();
    if (!options.verbosity.quiet)
      for (const std::string& warning : frame.warnings())
        fmt::print(stderr, "ssdo: {}\n", printable(frame.input + ": warning: " + warning));
  }
  report.input = options.input_file;
  report.method = options.model.method;
  report.filter = options.model.filter;
  report.frames = subject.frames;
  report.products = subject.products;
  report.processor = processor_name();
  report.processors = processor_count();
  report.threads = resources.threads();
  report.isa = resources.isa();
  const std::vector<ShotSetting> settings = shot_settings(find_frames(options.input_file).size());
  ProgressLine progress(options.batch.progress, options.verbosity.quiet);
  for (std::size_t i = 0; i < settings.size(); ++i) {
    const ShotSetting& setting = settings[i];
    const auto on_step = [&](double done) {
      progress.tell((double(i) + done) / double(settings.size()), setting.name());
    };
    on_step(0);
    MeasuredShot measured = measure_shot(subject, setting, on_step);
    report.rows.push_back({setting, measured.cost, std::move(measured.products),
                           command_of(subject, bench, setting)});
  }
  progress.clear();
  report.seconds = watch.lap() * 1e-3;
  const auto text_of = [&](const std::string& ending) {
    if (ending == ".csv") return to_csv(report);
    return ending == ".json" ? json_text(to_json(report), 2) + "\n" : to_html(report);
  };
  write_reports(text_of, bench.reports, options.output.policy);
  print_out(to_table(report));
  return ExitCode::done;
}

}  // namespace ssdo
