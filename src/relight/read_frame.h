// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "io/exr/deep_reader.h"
#include "relight/frame.h"

namespace ssdo {

/// Whether a product is made of what surfaces mirror.
bool wants_reflection(const OutputOptions& output, const std::vector<LayerRequest>& aovs);

/// Layers, G-buffer, camera and geometry of a frame, of which an overview is read if it is too
/// large for options.memory in the light of so many lamps. If the frame is read from a deep file,
/// `own` gets its samples. Errors: those of the stages; ExitCode::layer for a lat-long panorama.
Frame read_frame(const FrameOptions& options, const FrameFiles& files, int lamps,
                 std::optional<DeepImage>& own);

}  // namespace ssdo
