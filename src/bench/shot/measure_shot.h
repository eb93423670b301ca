// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "bench/shot/shot_report.h"
#include "bench/truth.h"
#include "jobs/machine/resources.h"
#include "jobs/run_options.h"

namespace ssdo {

/// A shot that is measured.
struct ShotSubject {
  const RunOptions& options;  ///< of the main job, for all settings
  const Resources& resources;
  std::vector<int> frames;
  std::vector<std::string> products;
  std::map<std::string, TruthRequest> truths;  ///< by product; pictures with frame patterns
};

/// What a setting was found to be.
struct MeasuredShot {
  Cost cost;
  std::map<std::string, ShotFigures> products;
};

/// Runs the main job over the frames with a setting, into a folder for temporary files, and
/// measures what it wrote. `on_step` is called with a share, 0..1.
/// Errors: those of run_batch; ExitCode of the run where a frame fails; those of read_truth,
/// read_points and ShotPoints.
MeasuredShot measure_shot(const ShotSubject& subject, const ShotSetting& setting,
                          const std::function<void(double)>& on_step);

}  // namespace ssdo
