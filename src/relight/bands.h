// SPDX-License-Identifier: Apache-2.0
//
// A frame that does not fit into memory. One pixel of every 8 x 8 is read first: this overview is a
// smaller frame by the same camera, from which everything is decided once. Then rows are read,
// computed and written in bands, each with those around it that its light comes from.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "relight/job.h"

namespace ssdo {

/// Estimates, filters, composes and writes a frame with Frame::bands, band by band. `relit` has the
/// overview for its scene; times and clamped values are added to it. Returns the files, for the
/// caller to commit. `on_progress` is called with the share that is done, 0..1. Errors: those of
/// the stages.
std::vector<std::unique_ptr<SafeFile>> relight_in_bands(
    const RelightJob& job, const std::function<void(double)>& on_progress, Relit& relit);

}  // namespace ssdo
