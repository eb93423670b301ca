// SPDX-License-Identifier: Apache-2.0
#include "bench/run_bench.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "bench/bench.h"
#include "bench/report_files.h"
#include "bench/shot/run_shot_bench.h"
#include "io/json_text.h"
#include "io/one_line.h"
#include "io/sequence.h"
#include "io/standard_output.h"
#include "jobs/describe.h"
#include "jobs/jobs.h"
#include "jobs/progress.h"

namespace ssdo {
namespace {

void print_findings(const Frame& frame, const Verbosity& verbosity) {
  if (verbosity.verbose) {
    fmt::print(stderr, "{}", describe(frame));
  } else if (!verbosity.quiet) {
    for (const std::string& warning : frame.warnings())
      fmt::print(stderr, "ssdo: {}\n", printable(frame.input + ": warning: " + warning));
  }
}

}  // namespace

ExitCode run_bench(const RunOptions& options, const BenchOptions& bench_options,
                   const Resources& resources) {
  const std::string& input = options.input_file;
  if (is_pattern(input)) return run_shot_bench(options, bench_options, resources);
  if (options.input.views.size() > 1) {
    throw Error(ExitCode::usage,
                fmt::format("{}: bench measures one view; give --stereo left or right", input));
  }
  const BenchJob job{input, options, bench_options};
  const Subject subject = read_subject(job, inputs_of(options, files_named(options)));
  print_findings(subject.frame, options.verbosity);

  ProgressLine progress(options.batch.progress, options.verbosity.quiet);
  BenchReport report = bench(
      job, subject, [&](double done, const std::string& setting) { progress.tell(done, setting); });
  progress.clear();
  report.frame = json_text(to_json(subject.frame));
  report.threads = resources.threads();
  report.isa = resources.isa();
  const auto text_of = [&](const std::string& ending) {
    if (ending == ".csv") return to_csv(report);
    return ending == ".json" ? json_text(to_json(report), 2) + "\n" : to_html(report);
  };
  write_reports(text_of, bench_options.reports, options.output.policy);
  print_out(to_table(report));
  return bench_options.wants.empty() || report.recommended ? ExitCode::done : ExitCode::failed;
}

}  // namespace ssdo
