// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "jobs/run_options.h"
#include "relight/estimate.h"
#include "relight/frame.h"

namespace ssdo {

/// The frame before in a run, as the next one sees it.
struct FrameBefore {
  bool is_last_in_time = false;  ///< its number is one less: motion vectors lead to it
  glm::vec2 motion_scale;        ///< --motion-scale
};

/// Decides for a frame of a temporal run what counts of `temporal`, whose history is that of the
/// frame before, where there is one. Moves the frame's motion into `temporal`, clears the history
/// after a cut, and says in the frame what was decided.
void place_in_sequence(Frame& frame, TemporalInput& temporal, const FrameBefore& before);

}  // namespace ssdo
