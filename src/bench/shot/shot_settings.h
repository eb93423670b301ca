// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "jobs/run_options.h"

namespace ssdo {

/// How a run uses the neighbouring frames of each frame.
struct ShotSetting {
  std::vector<std::string> arguments;  ///< of the main job; none: each frame alone
  int frames = 0;                      ///< how many it uses before and after each frame
  bool temporal = false;

  /// "alone", or the arguments.
  std::string name() const;

  RunOptions applied_to(RunOptions options) const;
};

/// Frames alone, --temporal, and 1, 2, 4 and 8 frames before and after, as far as a sequence of
/// `count` frames on disk has so many.
std::vector<ShotSetting> shot_settings(std::size_t count);

}  // namespace ssdo
