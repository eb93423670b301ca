// SPDX-License-Identifier: Apache-2.0
#include "cli/batch.h"

#include <fmt/format.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <future>
#include <new>
#include <nlohmann/json.hpp>
#include <utility>

#include "cli/describe.h"
#include "cli/jobs.h"
#include "cli/listing.h"
#include "cli/progress.h"
#include "cli/statistics.h"
#include "filters/continuity.h"
#include "frame.h"
#include "io/image_file.h"
#include "io/json_text.h"
#include "io/one_line.h"
#include "io/standard_output.h"
#include "pipeline.h"

namespace ssdo {
namespace {

namespace fs = std::filesystem;

bool is_readable(const std::string& path) {
  try {
    if (is_display_image(path)) {
      read_image(path);
    } else {
      // All channels of a part share their chunks: if one can be decoded, all can.
      const ExrReader file(path);
      for (const ExrPart& part : file.parts()) {
        if (!part.deep && !part.channels.empty())
          file.read_stored(part.index, std::vector{part.channels[0].name});
      }
    }
    return true;
  } catch (const Error&) {
    return false;
  }
}

bool all_done(const Job& job) {
  for (const Target& target : job.targets) {
    if (!fs::exists(target.path) || !is_readable(target.path)) return false;
  }
  return !job.targets.empty();
}

/// Runs the jobs one after another.
class Batch {
 public:
  Batch(const Options& options, const Resources& resources)
      : options_(options),
        resources_(resources),
        jobs_(plan_jobs(options)),
        progress_(options.batch.progress, options.verbosity.quiet) {
    for (const Job& job : jobs_) pictures_.expect(job.files);
  }

  ExitCode run() {
    ExitCode code = ExitCode::done;
    try {
      code = run_jobs();
    } catch (const Error& e) {
      note_in_info(e);
      print_infos();
      throw;
    }
    print_infos();
    if (has_statistics() && !options_.verbosity.dry_run)
      write_statistics(options_.verbosity.stats, policy_of_statistics(options_.output.policy),
                       statistics_);
    return code;
  }

 private:
  ExitCode run_jobs() {
    if (has_statistics())
      check_output(options_.verbosity.stats, policy_of_statistics(options_.output.policy));
    ExitCode code = ExitCode::done;
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      if (options_.command == Command::info) list(jobs_[i]);
      if (!light_) light_.emplace(options_.light);
      const std::optional<Error> error = error_of_job(i);
      pictures_.release(jobs_[i].files);
      if (error) {
        // A job of one frame fails if that frame fails.
        if (jobs_.size() == 1) throw *error;
        note_in_info(*error);
        say(error->what());
        if (code == ExitCode::done) code = error->code;
        if (options_.batch.on_error == OnError::stop) break;
      }
      progress_.tell(double(i + 1) / double(jobs_.size()), jobs_[i].files.input);
    }
    return code;
  }

  std::optional<Error> error_of_job(std::size_t i) {
    try {
      run_job(i);
      return std::nullopt;
    } catch (const Error& e) {
      return e;
    } catch (const std::bad_alloc&) {
      return Error(ExitCode::failed,
                   fmt::format("{}: not enough memory for this frame", jobs_[i].files.input));
    } catch (const std::exception& e) {
      return Error(ExitCode::failed, fmt::format("{}: {}", jobs_[i].files.input, e.what()));
    }
  }

  void run_job(std::size_t i) {
    const Job& job = jobs_[i];
    Past past{std::exchange(history_, std::nullopt), {}};
    OutputPolicy policy = options_.output.policy;
    const bool relights = options_.command == Command::relight;
    if (relights && options_.batch.skip_existing) {
      if (all_done(job)) return say_skipped(job);
      policy.overwrite = true;  // some of its files are missing or incomplete
    }
    for (const Target& target : job.targets) {
      if (relights) check_output(target.path, policy);
    }
    Frame frame = take_frame(i);
    if (options_.model.temporal) place_in_sequence(frame, i, past);
    if (options_.command == Command::info) return show(frame);
    if (options_.verbosity.dry_run || options_.verbosity.verbose) {
      print(describe(frame));
    } else if (!options_.verbosity.quiet) {
      for (const std::string& warning : frame.warnings()) {
        say(fmt::format("{}: warning: {}", job.files.input, warning));
      }
    }
    const RelightJob work{options_, frame, job.targets, policy};
    if (options_.verbosity.dry_run) return say_colors(work);
    const auto on_progress = [&](double done) {
      progress_.tell((double(i) + done) / double(jobs_.size()), job.files.input);
    };
    Relit relit = relight(work, on_progress, past);
    for (const std::string& note : relit.notes) say_verbose(note);
    for (const std::string& warning : relit.warnings) {
      if (!options_.verbosity.quiet) say(fmt::format("{}: warning: {}", job.files.input, warning));
    }
    if (relit.clamped_values > 0 && !options_.verbosity.quiet) {
      say(
          fmt::format("{}: warning: {} values were beyond the range of half and clamped to 65504; "
                      "keep them with --pixel-type float",
                      job.files.input, relit.clamped_values));
    }
    statistics_.push_back(statistics_of(frame, job, resources_, relit));
    if (!options_.model.temporal) return;
    history_ = std::move(relit.history);
    history_->geometry = std::move(frame.scene.geometry);
    history_->albedo = std::move(frame.scene.senders.albedo);
  }

  /// Reports from which frame the history is taken. Clears that of `past` after a cut.
  void place_in_sequence(Frame& frame, std::size_t i, Past& past) const {
    std::optional<History>& before = past.history;
    const Geometry& geometry = frame.scene.geometry;
    past.motion = std::move(frame.gbuffer.motion);
    std::string reason =
        !geometry.world_known ? "no history: the frame knows no world space"
        : before              ? "history of the frame before, where that shows the same surface"
                 : "no history: the first frame, or the one before was not made by this run";
    if (before && before->geometry.world_known && geometry.world_known) {
      const Continuity found = compare_frames({before->geometry, before->albedo},
                                              {geometry, frame.scene.senders.albedo}, past.motion);
      before->albedo = {};  // not needed any more
      if (found.is_cut()) {
        before.reset();
        reason = fmt::format(
            "no history: a cut, the frame before has {:.0f} % of the surfaces that both look at",
            100 * found.kept / found.met);
      }
    }
    frame.history.push_back(reason);
    if (before && !past.motion.empty()) place_motion(frame, past, i);
  }

  /// Motion vectors refer to the frame before in time, which may not be the one before in the list.
  void place_motion(Frame& frame, Past& past, std::size_t i) const {
    if (std::int64_t(*jobs_[i - 1].frame) + 1 != *jobs_[i].frame) {
      past.motion = {};
      frame.history.push_back("motion is not used: it leads to a frame that is not the last");
      return;
    }
    const std::string& name = frame.layers[Role::motion]->name;
    const glm::vec2 scale = options_.input.gbuffer.motion_scale.value_or(glm::vec2(1));
    frame.history.push_back(fmt::format(
        "motion {} times {:g}, {:g}: pixels to the frame before, y up, where what moves "
        "has its history",
        name, scale.x, scale.y));
    if (contradicts_cameras(past.history->geometry, frame.scene.geometry, past.motion)) {
      frame.report.warnings.push_back(
          fmt::format("{} moves other ways than the cameras say; are its units pixels to the frame "
                      "before, y up? give --motion-scale",
                      name));
    }
  }

  Frame prepare(std::size_t i) {
    const Job& job = jobs_[i];
    if (job.frame && !fs::exists(job.files.input)) {
      throw Error(ExitCode::input,
                  fmt::format("{}: frame {} of the range is missing", job.files.input, *job.frame));
    }
    return prepare_frame(options_, *light_, pictures_, job.files, job.frame.value_or(0));
  }

  /// The frame of job `i`, waiting for it if it is being read already; starts to read the next one.
  Frame take_frame(std::size_t i) {
    auto current = std::move(next_);
    const bool ahead = current.valid() && next_index_ == i;
    if (!ahead) return start_next(i, prepare(i));
    return start_next(i, current.get());
  }

  Frame start_next(std::size_t i, Frame frame) {
    if (resources_.threads() > 1 && i + 1 < jobs_.size() && !options_.batch.skip_existing) {
      next_index_ = i + 1;
      next_ = std::async(std::launch::async, [this, n = i + 1] { return prepare(n); });
    }
    return frame;
  }

  /// Called before anything that can fail, so that `info` lists the layers of every file.
  void list(const Job& job) {
    const std::deque<ExrReader> files = open_files(job.files);
    infos_.push_back(listing_json(job.files.input, files));
    print_info(list_layers(files));
  }

  void show(const Frame& frame) {
    infos_.back().update(to_json(frame));
    print_info(describe(frame));
  }

  void note_in_info(const Error& e) {
    if (!infos_.empty()) infos_.back()["error"] = {{"code", int(e.code)}, {"message", e.what()}};
  }

  void print_info(const std::string& text) {
    if (options_.verbosity.json) return;
    progress_.clear();
    print_out(text);
  }

  void print_infos() const {
    if (!options_.verbosity.json || infos_.empty()) return;
    const nlohmann::json& shown = infos_.size() == 1 ? infos_[0] : infos_;
    print_out(json_text(shown, 2) + "\n");
  }

  /// Prints one line on standard error; if that is closed, the work goes on.
  void say(const std::string& line) { print("ssdo: " + printable(line) + "\n"); }
  void print(const std::string& text) {
    progress_.clear();
    std::fputs(text.c_str(), stderr);
  }
  void say_verbose(const std::string& text) {
    if (options_.verbosity.verbose) say(text);
  }
  void say_skipped(const Job& job) {
    if (options_.verbosity.verbose || options_.verbosity.dry_run)
      say(fmt::format("{}: skipped, its outputs exist", job.files.input));
  }
  /// The end of a dry run: makes the last checks that come before the work of a real run.
  void say_colors(const RelightJob& job) {
    if (const auto display = make_display(job)) say(display->description());
  }

  /// Statistics are about products, which `info` does not make.
  bool has_statistics() const {
    return options_.command == Command::relight && !options_.verbosity.stats.empty();
  }

  const Options& options_;
  const Resources& resources_;
  std::vector<Job> jobs_;
  std::optional<Lighting> light_;  ///< read after the first listing of `info`
  FurtherPictures pictures_;       ///< of all frames
  ProgressLine progress_;
  nlohmann::json statistics_ = nlohmann::json::array(), infos_ = nlohmann::json::array();
  std::size_t next_index_ = 0;
  std::future<Frame> next_;
  std::optional<History> history_;  ///< of the frame before, where --temporal asks for it
};

}  // namespace

ExitCode run_batch(const Options& options, const Resources& resources) {
  return Batch(options, resources).run();
}

}  // namespace ssdo
