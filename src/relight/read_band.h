// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relight/job.h"

namespace ssdo {

/// Some rows of a frame, read and placed as the whole frame is.
struct Band {
  GBuffer gbuffer;
  Scene scene;
};

/// Reads `rows` of a frame and what casts there: objects of --no-cast, of --shadow-of and those
/// that block no light of a lamp are taken out as they are of `overview`, the scene of the frame.
/// What it takes adds to `times`. Errors: those of read_gbuffer(), build_geometry() and
/// selected_coverage().
Band read_band(const RelightJob& job, const Scene& overview, const Window& rows, StageTimes& times);

}  // namespace ssdo
