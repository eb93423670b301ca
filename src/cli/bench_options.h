// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/options.h"

namespace CLI {
class App;
}

namespace ssdo {

/// Declares `ssdo bench` on the command line. What it does not define itself it takes from `app`.
CLI::App* add_bench(CLI::App& app, BenchOptions& options);

/// Reads what was given for `bench`, once the line has been read: refuses options of the main job
/// that a ladder of methods and settings cannot follow, and keeps the others for the commands that
/// are recommended. Errors: ExitCode::usage.
void finish_bench(const CLI::App& app, BenchOptions& options);

}  // namespace ssdo
