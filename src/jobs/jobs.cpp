// SPDX-License-Identifier: Apache-2.0
#include "jobs/jobs.h"

#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <map>

#include "error.h"
#include "io/exr/exr_reader.h"
#include "io/images/image_file.h"
#include "io/pictures/picture_layers.h"
#include "io/sequence.h"
#include "jobs/machine/environment.h"

namespace ssdo {
namespace {

/// `text` with `sign` replaced by `word`.
std::string replaced(std::string text, std::string_view sign, std::string_view word) {
  for (auto at = text.find(sign); at != text.npos; at = text.find(sign, at + word.size()))
    text.replace(at, sign.size(), word);
  return text;
}

/// Adds a target; one for each view where the path has the signs %V or %v of Nuke for their names
/// and initials.
void add_target(const Target& target, const std::vector<std::string>& views,
                std::vector<Target>& targets) {
  const std::size_t before = targets.size();
  for (const std::string& view : views) {
    const std::string path = replaced(replaced(target.path, "%V", view), "%v", view.substr(0, 1));
    if (path != target.path) targets.push_back({path, target.product, view});
  }
  if (targets.size() > before) return;
  if (views.size() > 1 && !has_exr_ending(target.path)) {
    throw Error(ExitCode::usage, fmt::format("{}: shows one view; put %V into its name for that of "
                                             "the view, or give --stereo left or right",
                                             target.path));
  }
  targets.push_back(target);
}

std::vector<Target> targets_of(const OutputOptions& output, const std::vector<std::string>& views) {
  std::vector<Target> targets;
  for (const std::string& path : output.files) add_target({path, std::nullopt}, views, targets);
  for (const SaveRequest& save : output.saves)
    add_target({save.path, save.product}, views, targets);
  return targets;
}

/// The files of a frame, once for each view to relight.
std::vector<FrameFiles> views_of(const FrameFiles& files, const std::vector<std::string>& names) {
  std::vector<FrameFiles> views;
  for (const std::string& name : names) views.push_back(in_view(files, name));
  return views.empty() ? std::vector{files} : views;
}

void check_kinds(const std::vector<Target>& targets) {
  for (const Target& target : targets) {
    if (!has_exr_ending(target.path) && !is_display_image(target.path)) {
      throw Error(
          ExitCode::usage,
          fmt::format("{}: unknown kind of output; use .exr, .png, .jpg or .tif", target.path));
    }
  }
}

Job single_job(const RunOptions& options, std::vector<Target> targets) {
  if (options.model.temporal || options.model.shot.count > 0) {
    throw Error(ExitCode::usage,
                fmt::format("{}: {} needs a sequence, such as shot.####.exr", options.input_file,
                            options.model.temporal ? "--temporal" : "--shot"));
  }
  if (options.batch.frames) {
    throw Error(ExitCode::usage,
                fmt::format("{}: --frames needs a pattern in the input's name, such as "
                            "shot.####.exr",
                            options.input_file));
  }
  for (const Target& target : targets) {
    if (is_pattern(target.path)) {
      throw Error(ExitCode::usage, fmt::format("{}: has a frame pattern, but the input {} has none",
                                               target.path, options.input_file));
    }
  }
  return {std::nullopt, views_of(files_named(options), options.input.views), std::move(targets)};
}

Job job_of_frame(const RunOptions& options, const std::vector<Target>& targets, int frame) {
  FrameFiles files = files_at(options, frame);
  for (const std::string& path : options.input.also)
    files.also.push_back(expand_pattern(path, frame));
  Job job{frame, views_of(files, options.input.views), targets};
  for (Target& target : job.targets) target.path = expand_pattern(target.path, frame);
  return job;
}

/// The jobs of a shot by the numbers of their frames, together with lent frames: those outside of
/// `jobs` whose findings these want, where they exist.
std::vector<Job> with_lent_frames(const RunOptions& options, std::vector<Job> jobs) {
  std::map<int, Job> all;
  for (Job& job : jobs) {
    // Other frames may still want what this one finds.
    job.has_no_outputs = options.batch.skip_existing && is_done(job);
    all.emplace(*job.frame, std::move(job));
  }
  std::set<int> around;
  for (const auto& [frame, job] : all) {
    if (job.has_no_outputs) continue;
    for (const int other : frames_around(options.model.shot, frame)) around.insert(other);
  }
  for (const int frame : around) {
    if (all.contains(frame)) continue;
    Job neighbour = job_of_frame(options, {}, frame);
    neighbour.has_no_outputs = true;
    std::error_code ignored;
    if (std::filesystem::exists(neighbour.input(), ignored))
      all.emplace(frame, std::move(neighbour));
  }
  std::vector<Job> in_order;
  for (auto& [frame, job] : all) in_order.push_back(std::move(job));
  return in_order;
}

std::vector<Job> jobs_of_sequence(const RunOptions& options, const std::vector<Target>& targets) {
  const auto frames =
      options.batch.frames ? *options.batch.frames : find_frames(options.input_file);
  if (frames.empty()) {
    throw Error(ExitCode::input,
                fmt::format("{}: no frame of this sequence exists", options.input_file));
  }
  for (const Target& target : targets) {
    if (frames.size() > 1 && !is_pattern(target.path)) {
      throw Error(ExitCode::usage,
                  fmt::format("{}: {} frames would go to this one file; put a pattern into its "
                              "name, such as out.####.exr",
                              target.path, frames.size()));
    }
  }
  std::vector<Job> jobs;
  for (int frame : frames) jobs.push_back(job_of_frame(options, targets, frame));
  const bool tells = options.model.shot.count > 0 && !options.verbosity.dry_run &&
                     (options.command == Command::relight || options.command == Command::info);
  return tells ? with_lent_frames(options, std::move(jobs)) : jobs;
}

void add_outputs(const Job& job, RunFiles& files) {
  for (const Target& target : job.targets)
    files.outputs.push_back({target.product ? "--save" : "-o", target.path});
}

void add_mattes(const Selection& selection, RunFiles& files) {
  for (const SelectionTerm& term : selection.terms)
    files.inputs.push_back({selection.option, term.file});
}

RunFiles files_of(const RunOptions& options, const std::vector<Job>& jobs) {
  RunFiles files;
  for (const Job& job : jobs) {
    const auto inputs = inputs_of(options, job.views.front());
    files.inputs.insert(files.inputs.end(), inputs.begin(), inputs.end());
    add_outputs(job, files);
  }
  if (!options.verbosity.stats.empty())
    files.outputs.push_back({"--stats", options.verbosity.stats});
  return files;
}

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

}  // namespace

std::vector<int> frames_around(const ShotWindow& shot, int frame) {
  std::vector<int> frames;
  const auto add = [&](int k) {
    const std::int64_t number = frame + std::int64_t(k) * shot.step;
    if (std::int64_t(int(number)) == number) frames.push_back(int(number));
  };
  for (int k = 1; k <= shot.count; ++k) add(-k);
  for (int k = 0; k <= shot.count; ++k) add(k);
  return frames;
}

FrameFiles files_at(const RunOptions& options, int frame) {
  FrameFiles files{expand_pattern(options.input_file, frame), options.input.aovs, {}};
  for (LayerRequest& request : files.aovs) request.file = expand_pattern(request.file, frame);
  files.objects = at_frame(options.input.objects, frame);
  return files;
}

std::vector<Job> plan_jobs(const RunOptions& options) {
  std::vector<Target> targets = targets_of(options.output, options.input.views);
  check_kinds(targets);
  std::vector<Job> jobs = is_pattern(options.input_file)
                              ? jobs_of_sequence(options, targets)
                              : std::vector{single_job(options, std::move(targets))};
  if (options.command == Command::relight) check_run_files(files_of(options, jobs));
  return jobs;
}

void check_lamp_files(const std::vector<Job>& jobs, const std::vector<Lamp>& lamps) {
  RunFiles files;
  for (const Job& job : jobs) {
    add_outputs(job, files);
    for (const Lamp& lamp : lamps)
      for (const Selection& selection : {lamp.receive, lamp.cast})
        add_mattes(job.frame ? at_frame(selection, *job.frame) : selection, files);
  }
  check_run_files(files);
}

std::set<std::filesystem::path> output_folders(const std::vector<Job>& jobs) {
  std::set<std::filesystem::path> folders;
  for (const Job& job : jobs) {
    for (const Target& target : job.targets)
      folders.insert(std::filesystem::path(target.path).parent_path());
  }
  return folders;
}

void check_input(const Job& job) {
  std::error_code ignored;
  // If the folder is not accessible, opening the file reports it later.
  const auto kind = std::filesystem::status(job.input(), ignored).type();
  if (!job.frame || kind != std::filesystem::file_type::not_found) return;
  throw Error(ExitCode::input, fmt::format("{}: frame {} of the range is missing; render it or "
                                           "leave it out of --frames",
                                           job.input(), *job.frame));
}

bool is_done(const Job& job) {
  for (const Target& target : job.targets) {
    std::error_code ignored;
    if (!std::filesystem::exists(target.path, ignored) || !is_readable(target.path)) return false;
  }
  return !job.targets.empty();
}

FrameFiles files_named(const RunOptions& options) {
  FrameFiles files{options.input_file, options.input.aovs, options.input.also};
  files.objects = options.input.objects;
  return files;
}

std::vector<RunFile> inputs_of(const RunOptions& options, const FrameFiles& files) {
  std::vector<RunFile> inputs = {{"INPUT", files.input},
                                 {"--env", parse_picture_name(options.light.env).file},
                                 {"--camera", options.camera.file},
                                 {"--ocio", options.color.ocio},
                                 {"$OCIO", std::string(variable("OCIO"))},
                                 {"--config", options.config_file}};
  for (const LayerRequest& request : files.aovs) inputs.push_back({"--aov", request.file});
  for (const std::string& path : files.also) inputs.push_back({"--also", path});
  for (const std::string& path : options.light.lamp_files) inputs.push_back({"--lights", path});
  RunFiles mattes;
  for (const Selection* selection : files.objects.all()) add_mattes(*selection, mattes);
  inputs.insert(inputs.end(), mattes.inputs.begin(), mattes.inputs.end());
  return inputs;
}

}  // namespace ssdo
