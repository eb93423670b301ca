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

namespace ssdo {

/// One frame of a run, with the patterns of its files replaced.
struct Job {
  std::optional<int> frame;
  std::vector<FrameFiles> views;  ///< those to relight, of one file; usually one
  std::vector<Target> targets;

  const std::string& input() const { return views.front().input; }
};

/// The frames of a run in their order.
/// Errors: ExitCode::usage for patterns, frames and kinds of output that do not fit together;
/// ExitCode::input for a sequence without frames; those of check_run_files, over all frames.
std::vector<Job> plan_jobs(const RunOptions& options);

/// The folders that the outputs of all jobs go to.
std::set<std::filesystem::path> output_folders(const std::vector<Job>& jobs);

/// Errors: ExitCode::input for a frame of a sequence that does not exist.
void check_input(const Job& job);

/// Whether all outputs of a job exist and can be read.
bool is_done(const Job& job);

/// The files of a frame whose names hold no patterns. Errors: ExitCode::usage for --neighbours,
/// which such a frame has not.
FrameFiles files_named(const RunOptions& options);

/// The files of a frame of a sequence without other views, with its number in their patterns.
FrameFiles files_at(const RunOptions& options, int frame);

/// Every file that a frame is made from: `files`, those of --env, --camera, --config and the
/// OpenColorIO config.
std::vector<RunFile> inputs_of(const RunOptions& options, const FrameFiles& files);

}  // namespace ssdo
