// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/options.h"
#include "cli/resources.h"
#include "error.h"

namespace ssdo {

/// `ssdo bench`: measures on one frame, writes the reports and prints the table. Gives
/// ExitCode::failed where no setting has the error that is wanted.
/// Errors: those of read_subject and bench; ExitCode::usage for a sequence; output for reports.
ExitCode run_bench(const Options& options, const Resources& resources);

}  // namespace ssdo
