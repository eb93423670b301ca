// SPDX-License-Identifier: Apache-2.0
//
// What may be wrong with a frame although it can be relit.
#pragma once

#include "relight/frame.h"

namespace ssdo {

/// Colours are not decoded: the outputs keep the header, which says how they are encoded.
void warn_of_encoded_colors(Frame& frame);

/// Missing layers, a radius in another unit, and options that change nothing of a planned frame.
/// `has_deep_pixels`: a deep image of the frame is known.
void warn_of_plan(Frame& frame, const FrameOptions& options, bool has_deep_pixels);

/// What is in a file besides the render, as it is an output of ssdo: a reason of the plan.
void explain_earlier_products(Frame& frame);

}  // namespace ssdo
