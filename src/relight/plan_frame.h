// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "relight/frame.h"

namespace ssdo {

/// Decides what is computed of a frame whose scene is complete, and says why; fills plan, bands,
/// advice and warnings. `number` is the frame's in its sequence; `has_deep_pixels`: a deep image of
/// it is known. Errors: those of make_plan and plan_bands.
void plan_frame(Frame& frame, const FrameOptions& options, int number, bool has_deep_pixels);

}  // namespace ssdo
