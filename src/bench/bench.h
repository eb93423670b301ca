// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/options.h"
#include "error.h"

namespace ssdo {

/// What `ssdo bench` prints; ExitCode::failed where no setting has the error that was wanted.
struct BenchOutcome {
  std::string text;
  ExitCode code = ExitCode::done;
};

/// Measures the settings of the methods on one frame and writes the reports, which say on how many
/// threads and on which instruction set.
/// Errors: those of prepare_frame, make_plan and read_truth; ExitCode::output for reports.
BenchOutcome bench(const Options& options, int threads, const std::string& isa);

}  // namespace ssdo
