// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/options.h"
#include "error.h"
#include "jobs/machine/resources.h"
#include "jobs/run_options.h"

namespace ssdo {

/// `ssdo bench`: measures on one frame, or on a sequence as run_shot_bench() does, writes the
/// reports and prints the table. Gives ExitCode::failed where no setting has the error that is
/// wanted.
/// Errors: those of read_subject and bench, or run_shot_bench; output for reports.
ExitCode run_bench(const RunOptions& options, const BenchOptions& bench_options,
                   const Resources& resources);

}  // namespace ssdo
