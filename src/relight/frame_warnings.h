// SPDX-License-Identifier: Apache-2.0
//
// What may be wrong with a frame although it can be relit.
#pragma once

#include "relight/frame.h"

namespace ssdo {

/// Colours are not decoded: the outputs keep the header, which says how they are encoded.
void warn_of_encoded_colors(Frame& frame);

/// Options for the depth, of a frame that has none.
void warn_of_idle_depth_options(Frame& frame, const GBufferOptions& options);

/// Missing layers, a radius in another unit, and options that change nothing of a planned frame.
void warn_of_plan(Frame& frame, const FrameOptions& options);

/// What is in a file besides the render, as it is an output of ssdo: a reason of the plan.
void explain_earlier_products(Frame& frame);

}  // namespace ssdo
