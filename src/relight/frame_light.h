// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relight/frame.h"
#include "relight/lighting.h"

namespace ssdo {

/// Places the environment and the lamps in a frame: sets the light of its scene and the line that
/// describes it. Warns where nothing in the frame tells how the map and the lamps lie in it. Asks
/// options.up_of_shot where neither the user nor a header says which axis is up. `number` is the
/// frame's in its sequence. Errors: those of find_receivers().
void light_frame(Frame& frame, const Lighting& lighting, const FrameOptions& options,
                 const FrameFiles& files, int number);

}  // namespace ssdo
