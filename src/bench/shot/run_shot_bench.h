// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/options.h"
#include "error.h"
#include "jobs/machine/resources.h"
#include "jobs/run_options.h"

namespace ssdo {

/// `ssdo bench` of a sequence: error, flicker and time of whole runs whose frames take part in each
/// other more and more. Writes the reports and prints the table.
/// Errors: those of measure_shot and prepare_frame; ExitCode::usage for options of a single frame
/// and for a truth that is no sequence; input where no frame exists, or no frame of a truth; output
/// for reports.
ExitCode run_shot_bench(const RunOptions& options, const BenchOptions& bench_options,
                        const Resources& resources);

}  // namespace ssdo
