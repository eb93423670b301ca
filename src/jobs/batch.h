// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "error.h"
#include "jobs/machine/resources.h"
#include "jobs/run_options.h"

namespace ssdo {

/// The main job and `info`, over one frame or a sequence. Where there is more than one thread, the
/// frame before is written and the next one read while a frame is estimated. Prints one line per
/// failed frame and returns the exit code of the first; what is wrong before the first frame is
/// thrown.
ExitCode run_batch(const RunOptions& options, const Resources& resources);

}  // namespace ssdo
