// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/options.h"
#include "compare.h"
#include "frame.h"

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

struct Options : FrameOptions {
  Command command = Command::relight;
  std::string input_file;
  BatchOptions batch;
  Verbosity verbosity;
  CompareOptions compare;
  BenchOptions bench;
  std::optional<int> threads;            ///< not given: see choose_thread_count()
  std::optional<std::size_t> mem_limit;  ///< in bytes; not given: see choose_memory()
  std::string config_file;               ///< that was read; empty: none
  std::vector<std::string> warnings;     ///< options that have no effect beside the others
};

/// What the command line asks for: work, or a text to print (--help, --completions).
struct ParsedOptions {
  Options options;
  std::optional<std::string> print;
};

/// Parses and validates. Errors: ExitCode::usage, one line.
ParsedOptions parse_options(int argc, const char* const* argv);

}  // namespace ssdo
