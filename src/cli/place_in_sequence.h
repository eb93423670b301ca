// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "cli/options.h"
#include "estimate.h"
#include "frame.h"

namespace ssdo {

/// The frame before in a run, as the next one sees it.
struct FrameBefore {
  bool is_last_in_time = false;  ///< its number is one less: motion vectors lead to it
  glm::vec2 motion_scale;        ///< --motion-scale
};

/// prepare_frame(). Where P leaves the camera of a frame of a sequence open, its lens is that of
/// the nearest frame on disk whose P tells it, so that it does not matter which frames are in the
/// run; the pose is fitted from its own P. Errors: those of prepare_frame().
Frame prepare_in_sequence(const Options& options, const Lighting& light, FurtherPictures& pictures,
                          const FrameFiles& files, std::optional<int> number);

/// Decides for a frame of a temporal run what counts of `past`, whose history is that of the frame
/// before, where there is one. Moves the frame's motion into `past`, clears the history after a
/// cut, and says in the frame what was decided.
void place_in_sequence(Frame& frame, Past& past, const FrameBefore& before);

}  // namespace ssdo
