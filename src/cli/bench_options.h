// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/options.h"

namespace CLI {
class App;
}

namespace ssdo {

/// Declares `ssdo bench` on the command line. It also takes the options of `app`.
CLI::App* add_bench(CLI::App& app, BenchOptions& options);

/// Whether bench refuses this option of the main job.
bool is_refused_by_bench(const std::string& flag);

/// Completes the options of `bench` after the command line has been parsed: refuses options of the
/// main job that make no sense for several methods and settings, or for a sequence and several ways
/// to take its frames together, and keeps the others for the commands that the report recommends.
/// Errors: ExitCode::usage.
void finish_bench(const CLI::App& app, bool of_sequence, BenchOptions& options);

}  // namespace ssdo
