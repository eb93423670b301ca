// SPDX-License-Identifier: Apache-2.0
//
// What a sequence does at one time, with two threads or more:
//
//   estimate and filter frame n, and beside it
//   compose and write frame n - 1, then read and prepare frame n + 1
//
// The frame before is written and freed before the next one is read, so that no more than two are
// in memory, and those that wait for the rest of their shot (jobs/sequence/shot.h). Lines, errors
// and statistics of a frame wait until those of the frame before are out.
#include "jobs/batch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "io/files/stale_temporaries.h"
#include "io/standard_output.h"
#include "jobs/describe.h"
#include "jobs/info_report.h"
#include "jobs/jobs.h"
#include "jobs/machine/memory.h"
#include "jobs/messages.h"
#include "jobs/progress.h"
#include "jobs/sequence/frame_changes.h"
#include "jobs/sequence/place_in_sequence.h"
#include "jobs/sequence/sequence_frames.h"
#include "jobs/sequence/shot.h"
#include "jobs/sequence/shot_report.h"
#include "jobs/statistics.h"
#include "jobs/work.h"
#include "parallel/background_task.h"
#include "relight/frame.h"
#include "relight/relight.h"
#include "relight/targets.h"

namespace ssdo {
namespace {

constexpr const char* kSkipped = ": skipped, its outputs exist";

class Batch {
 public:
  Batch(const RunOptions& options, const Resources& resources)
      : options_(options),
        resources_(resources),
        jobs_(plan_jobs(options)),
        overlaps_(resources.threads() > 1 && jobs_.size() > 1),
        // A temporal frame hands its surfaces to the next one, which therefore waits.
        writes_behind_(overlaps_ && !options.model.temporal),
        pictures_(options.input.allow_partial, options.input.objects),
        frames_(options_, pictures_),
        shot_(jobs_, options.model.shot, options.command == Command::info,
              {resources.memory(), frames_at_one_time()}),
        progress_(options.batch.progress, options.verbosity.quiet),
        info_(options.verbosity.json, progress_),
        printer_(progress_) {
    options_.memory = resources.memory() / std::size_t(frames_at_one_time()) /
                      std::max(std::size_t(1), options.input.views.size());
    for (const Job& job : jobs_)
      for (const FrameFiles& files : job.views) pictures_.expect(files);
  }

  ExitCode run() {
    ExitCode code = ExitCode::done;
    try {
      code = run_jobs();
    } catch (const Error& e) {
      info_.note(e);
      info_.finish();
      throw;
    }
    std::vector<std::string> summary = report_.summary();
    for (const std::string& line : printer_.summary()) summary.push_back(line);
    for (std::string& line : summary) {
      line.insert(0, options_.input_file);
      if (!options_.verbosity.quiet) printer_.print(line);
    }
    info_.finish();
    report_.add_to(statistics_, summary);
    if (has_statistics() && !options_.verbosity.dry_run)
      write_statistics(options_.verbosity.stats, policy_of_statistics(options_.output.policy),
                       statistics_);
    return code;
  }

 private:
  /// A frame that is made with those around it takes about as much as one that is estimated.
  int frames_at_one_time() const { return 1 + overlaps_ + (options_.model.shot.count > 0); }

  ExitCode run_jobs() {
    if (has_statistics())
      check_output(options_.verbosity.stats, policy_of_statistics(options_.output.policy));
    if (options_.command == Command::relight && !options_.verbosity.dry_run) clean_folders();
    for (std::size_t i = 0; i < jobs_.size() && !stopped_; ++i) {
      if (options_.command == Command::info && !jobs_[i].has_no_outputs)
        info_.list(jobs_[i].views.front());
      if (!light_) read_light();
      run_job(i);
    }
    if (behind_ && !stopped_) {
      write(*behind_, progress_of(behind_->index));
      conclude(*behind_);
    }
    return code_;
  }

  void read_light() {
    light_.emplace(options_.light);
    if (options_.command == Command::relight) check_lamp_files(jobs_, light_->lamps());
  }

  /// Removes what killed runs have left in the folders of the outputs.
  void clean_folders() {
    for (const std::filesystem::path& folder : output_folders(jobs_)) {
      for (const std::filesystem::path& file : remove_stale_temporaries(folder)) {
        if (options_.verbosity.verbose)
          printer_.print(file.string() + ": removed; the run that wrote it was killed");
      }
    }
  }

  void run_job(std::size_t i) {
    Work now = ahead_ ? *std::exchange(ahead_, {}) : prepare(i);
    if (overlaps_) {
      beside_.start([this, i] {
        if (behind_) write(*behind_, [](double) {});
        if (i + 1 < jobs_.size()) ahead_ = prepare(i + 1);
      });
    }
    compute(now);
    shot_.add(std::move(now));
    std::optional<Work> made = next_made();
    if (made && !writes_behind_) write(*made, progress_of(made->index));
    beside_.wait();
    if (behind_) conclude(*behind_);
    behind_.reset();
    // After the last frame of a shot, those that waited for it are made and written one by one.
    for (; made && !stopped_; made = next_made()) {
      if (writes_behind_ && !made->views.empty() && !shot_.has_complete()) {
        behind_ = std::move(made);
        return;
      }
      write(*made, progress_of(made->index));
      conclude(*made);
    }
  }

  /// The next frame that needs no others any more. `info` reports what the others show of it.
  std::optional<Work> next_made() {
    if (!shot_.has_complete()) return std::nullopt;
    std::optional<Work> work = shot_.next_complete();
    if (!shot_.only_looks()) return work;
    for (const WorkOnView& view : work->views)
      if (view.shown) info_.show(view.frame, *view.shown);
    work->views.clear();
    return work;
  }

  template <class Step>
  void attempt(Work& work, const Step& step) {
    ssdo::attempt(work, jobs_[work.index].input(), step);
  }

  /// Up to the plan; there are no views where the job is skipped.
  Work prepare(std::size_t i) {
    Work work{.index = i,
              .policy = options_.output.policy,
              .messages = Messages(jobs_[i].input(), options_.verbosity)};
    attempt(work, [&] {
      if (may_skip(work)) return;
      const Job& job = jobs_[i];
      check_input(job);
      for (const FrameFiles& files : job.views) work.views.push_back({prepare_view(job, files)});
      if (work.views.size() > 1)
        work.messages.warn(compare_views(work.views[0].frame, work.views[1].frame), "");
      note_changes(work);
    });
    for (const FrameFiles& files : jobs_[i].views) pictures_.release(files);
    return work;
  }

  /// Errors name the view where there are several.
  Frame prepare_view(const Job& job, const FrameFiles& files) {
    if (job.views.size() == 1) return frames_.prepare(*light_, files, job.frame);
    try {
      Frame frame = frames_.prepare(*light_, files, job.frame);
      if (!frame.bands) return frame;
    } catch (const Error& e) {
      throw Error(e.code, fmt::format("{} (view {})", e.what(), files.view));
    }
    throw Error(ExitCode::usage, fmt::format("{}: two views of this size need more memory than "
                                             "there is; give --stereo left, then right",
                                             files.input));
  }

  /// Adds warnings of what differs from the frame before; frames are prepared one after the other.
  void note_changes(Work& work) {
    const Job& job = jobs_[work.index];
    for (std::size_t v = 0; v < work.views.size() && !job.has_no_outputs; ++v) {
      const Frame& frame = work.views[v].frame;
      const FrameTraits traits = traits_of(frame, job.views[v], job.frame.value_or(0));
      work.messages.warn(report_.add(work.index, traits), frame.view, true);
    }
  }

  /// Whether the outputs are there. Errors: those of check_output().
  bool may_skip(Work& work) const {
    const Job& job = jobs_[work.index];
    if (job.has_no_outputs) {
      if (!job.targets.empty() && (options_.verbosity.verbose || options_.verbosity.dry_run))
        work.messages.add(job.input() + kSkipped);
      return !shot_.is_wanted(work.index);
    }
    if (options_.command != Command::relight) return false;
    if (options_.batch.skip_existing) {
      if (is_done(job)) {
        if (options_.verbosity.verbose || options_.verbosity.dry_run)
          work.messages.add(job.input() + kSkipped);
        return true;
      }
      work.policy.overwrite = true;  // some of its files are missing or incomplete
    }
    for (const Target& target : job.targets) check_output(target.path, work.policy);
    return false;
  }

  /// Estimates and filters, or shows what would be done.
  void compute(Work& work) {
    std::vector<std::optional<History>> before = std::exchange(histories_, {});
    before.resize(work.views.size());
    attempt(work, [&] {
      for (std::size_t v = 0; v < work.views.size(); ++v)
        compute(work, work.views[v], before[v], share_of(work, v));
      if (shot_.only_looks()) return;
      if (options_.command == Command::info || options_.verbosity.dry_run) work.views.clear();
    });
  }

  void compute(Work& work, WorkOnView& view, std::optional<History>& before,
               const std::function<void(double)>& on_progress) {
    Frame& frame = view.frame;
    TemporalInput temporal{std::move(before), {}};
    if (options_.model.temporal) place_in_sequence(frame, temporal, before_of(work.index));
    if (options_.command == Command::info || options_.verbosity.dry_run) note_losses(work, frame);
    if (jobs_[work.index].has_no_outputs) {
      if (options_.command == Command::info) return;
      view.relit = relight(job_of(work, view), std::move(frame.scene), on_progress, temporal);
      return note_losses(work, frame);
    }
    const bool describes = options_.verbosity.dry_run || options_.verbosity.verbose;
    if (describes || options_.command == Command::info)
      work.messages.note(frame.warnings(), frame.view);
    else
      work.messages.warn(frame.warnings(), frame.view);
    if (options_.command == Command::info) return info_.show(frame);
    if (describes)
      work.messages.add_text(describe(frame));
    else if (!jobs_[work.index].frame && !options_.verbosity.quiet)
      work.advice = frame.guessed.advice();
    const RelightJob job = job_of(work, view);
    if (options_.verbosity.dry_run) {
      // The last checks that come before the work of a real run.
      if (const auto display = make_display(job)) work.messages.add(display->description());
      return;
    }
    if (!behind_ && !shot_.is_waiting()) print(work);
    view.relit = relight(job, std::move(frame.scene), on_progress, temporal);
    if (options_.verbosity.verbose)
      for (const std::string& note : view.relit.notes) work.messages.add(note);
    work.messages.warn(view.relit.warnings, frame.view);
  }

  /// Makes the outputs of a frame that was computed, and frees it.
  void write(Work& work, const std::function<void(double)>& on_progress) {
    if (work.views.empty()) return;
    attempt(work, [&] {
      std::vector<RelitFrame> relit;
      for (WorkOnView& view : work.views) relit.push_back({job_of(work, view), &view.relit});
      write_outputs(relit, on_progress);
      if (const std::size_t clamped = work.views.front().relit.clamped_values) {
        const std::string warning = fmt::format(
            "{} values were beyond the range of half and clamped to 65504; keep them "
            "with --pixel-type float",
            clamped);
        work.messages.warn({warning}, "");
        work.views.front().relit.warnings.push_back(warning);
      }
      for (WorkOnView& view : work.views) {
        note_losses(work, view.frame);
        if (!work.statistics) work.statistics = std::make_shared<nlohmann::json>();
        work.statistics->push_back(
            statistics_of(view.frame, jobs_[work.index], resources_, view.relit));
        if (!options_.model.temporal) continue;
        History& history = *histories_.emplace_back(std::move(view.relit.history));
        history.geometry = std::move(view.relit.scene.geometry);
        history.albedo = std::move(view.relit.scene.senders.albedo);
      }
    });
    work.views.clear();
  }

  static void note_losses(Work& work, const Frame& frame) {
    for (const std::string& loss : frame.losses()) work.losses.insert(loss);
  }

  /// Prints the result of a job, once all those before it are concluded.
  void conclude(Work& work) {
    for (const std::string& loss : work.losses) work.messages.add(loss + "; taken as background");
    if (!work.losses.empty() && code_ == ExitCode::done) code_ = ExitCode::input;
    if (jobs_[work.index].has_no_outputs) return conclude_without_outputs(work);
    if (!work.error && !work.advice.empty())
      work.messages.add(jobs_[work.index].input() + ": " + work.advice);
    print(work);
    if (work.statistics)
      for (nlohmann::json& view : *work.statistics) statistics_.push_back(std::move(view));
    if (work.error) {
      // A job of one frame fails if that frame fails.
      if (jobs_.size() == 1) throw *work.error;
      info_.note(*work.error);
      printer_.print(work.error->what());
      if (code_ == ExitCode::done) code_ = work.error->code;
      stopped_ = options_.batch.on_error == OnError::stop;
      if (stopped_) return;
    }
    progress_of(work.index)(1);
  }

  /// The frames around a lent frame do not fail if it does.
  void conclude_without_outputs(Work& work) {
    print(work);
    if (work.error)
      printer_.print(fmt::format("the frames around it do without it: {}", work.error->what()));
    progress_of(work.index)(1);
  }

  RelightJob job_of(const Work& work, const WorkOnView& view) const {
    return {options_, view.frame, jobs_[work.index].targets, work.policy};
  }

  FrameBefore before_of(std::size_t i) const {
    return {i > 0 && std::int64_t(*jobs_[i - 1].frame) + 1 == *jobs_[i].frame,
            options_.input.gbuffer.motion_scale.value_or(glm::vec2(1))};
  }

  std::function<void(double)> progress_of(std::size_t i) {
    return [this, i](double done) {
      progress_.tell((double(i) + done) / double(jobs_.size()), jobs_[i].input());
    };
  }

  /// The share of a job's time that one of its views takes.
  std::function<void(double)> share_of(const Work& work, std::size_t view) {
    return [tell = progress_of(work.index), view, count = double(work.views.size())](double done) {
      tell((double(view) + done) / count);
    };
  }

  void print(Work& work) {
    printer_.print(work.messages, work.index, jobs_[work.index].frame.value_or(0));
  }

  /// Statistics are about products, which `info` does not make.
  bool has_statistics() const {
    return options_.command == Command::relight && !options_.verbosity.stats.empty();
  }

  RunOptions options_;
  const Resources& resources_;
  std::vector<Job> jobs_;
  const bool overlaps_;            ///< frames are read and written beside the one that is estimated
  const bool writes_behind_;       ///< frames are written beside it too
  std::optional<Lighting> light_;  ///< read after the first listing of `info`
  OtherPictures pictures_;         ///< of all frames
  SequenceFrames frames_;
  Shot shot_;
  ProgressLine progress_;
  InfoReport info_;
  Printer printer_;
  nlohmann::json statistics_ = nlohmann::json::array();
  ExitCode code_ = ExitCode::done;
  bool stopped_ = false;
  ShotReport report_;
  std::vector<std::optional<History>> histories_;  ///< of the frame before's views, for --temporal
  std::optional<Work> ahead_;                      ///< the next job, prepared
  std::optional<Work> behind_;                     ///< computed and not concluded
  BackgroundTask beside_;                          ///< is waited for before any of the above goes
};

}  // namespace

ExitCode run_batch(const RunOptions& options, const Resources& resources) {
  return Batch(options, resources).run();
}

}  // namespace ssdo
