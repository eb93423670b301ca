// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "io/files/run_files.h"
#include "jobs/run_options.h"
#include "relight/job.h"
#include "scene/light/lamps/lamp.h"

namespace ssdo {

/// One frame of a run, with the patterns of its files replaced.
struct Job {
  std::optional<int> frame;
  std::vector<FrameFiles> views;  ///< those to relight, of one file; usually one
  std::vector<Target> targets;
  bool has_no_outputs =
      false;  ///< it makes nothing: only other frames of its shot want what it finds

  const std::string& input() const { return views.front().input; }
};

/// The frames of a run in the order of --frames; those of a shot in the order of their numbers.
/// Errors: ExitCode::usage for
/// patterns, frames and kinds of output that do not fit together; ExitCode::input for a sequence
/// without frames; those of check_run_files, over all frames.
std::vector<Job> plan_jobs(const RunOptions& options);

/// The frames that tell a frame of a shot what they have found: those before it from the nearest
/// on, itself, and those after it from the nearest on.
std::vector<int> frames_around(const ShotWindow& shot, int frame);

/// Refuses outputs that would replace a matte that a lamp is linked by: lamps are read after
/// plan_jobs(). Errors: those of check_run_files.
void check_lamp_files(const std::vector<Job>& jobs, const std::vector<Lamp>& lamps);

/// The folders that the outputs of all jobs go to.
std::set<std::filesystem::path> output_folders(const std::vector<Job>& jobs);

/// Errors: ExitCode::input for a frame of a sequence that does not exist.
void check_input(const Job& job);

/// Whether all outputs of a job exist and can be read.
bool is_done(const Job& job);

/// The files of a frame whose names hold no patterns.
FrameFiles files_named(const RunOptions& options);

/// The files of a frame of a sequence without other views, with its number in their patterns.
FrameFiles files_at(const RunOptions& options, int frame);

/// Every file that a frame is made from: `files`, those of --env, --camera, --config and the
/// OpenColorIO config.
std::vector<RunFile> inputs_of(const RunOptions& options, const FrameFiles& files);

}  // namespace ssdo
