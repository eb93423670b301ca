// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "relight/frame.h"

namespace ssdo {

enum class Command { relight, info, compare, bench, list_methods };

enum class OnError { stop, keep_going };
enum class ProgressStyle { automatic, none, tractor, alfred, openjd };

struct BatchOptions {
  std::optional<std::vector<int>> frames;  ///< every frame that exists where not given
  bool skip_existing = false;
  OnError on_error = OnError::stop;
  ProgressStyle progress = ProgressStyle::automatic;
};

/// How much the tool prints, and where.
struct Verbosity {
  bool verbose = false, quiet = false;
  bool dry_run = false;
  bool json = false;  ///< of `info`
  std::string stats;  ///< file for the statistics; empty: none
};

/// What a run over one frame or a sequence is to do.
struct RunOptions : FrameOptions {
  Command command = Command::relight;
  std::string input_file;
  BatchOptions batch;
  Verbosity verbosity;
  std::string config_file;  ///< that was read; empty: none
};

}  // namespace ssdo
