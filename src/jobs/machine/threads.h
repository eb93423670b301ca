// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "parallel/thread_start.h"

namespace ssdo {

inline constexpr int kMostThreads = 4096;

/// How many threads to use: `requested` if given, else $SSDO_THREADS, else $CUE_THREADS, else
/// $SLURM_CPUS_PER_TASK, else the least CPU quota of the control groups, else the processors that
/// this thread may run on; a quota never gives more threads than that. A scheduler's variable that
/// is not 1 to kMostThreads is ignored, since the user does not set it. `root` is where /proc and
/// /sys are. Errors: ExitCode::usage for an $SSDO_THREADS that is not 1 to kMostThreads.
int choose_thread_count(std::optional<int> requested, const std::filesystem::path& root = "/");

/// How many of `count` threads a run can have, found by starting as many as its libraries will and
/// ending them: OpenEXR, oneTBB and OpenImageIO crash or wait for ever where they get fewer than
/// they ask for. Errors: ExitCode::failed where there are not even those of a single-threaded run.
int startable_threads(int count);

/// The processors of a quota of control groups v2, rounded up: "200000 100000" is the time and the
/// period in microseconds, and gives 2. Nothing for "max" and for any other text.
std::optional<int> processors_of_quota(const std::string& cpu_max);

}  // namespace ssdo
