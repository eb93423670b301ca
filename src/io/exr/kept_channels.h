// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfFrameBuffer.h>

#include <string>
#include <vector>

#include "io/exr/exr_output.h"

namespace ssdo {

/// A channel of the input on its way into the output, at the output's size.
struct KeptChannel {
  std::string name;  ///< in the output
  StoredChannel stored;
};

/// The channels of the input that stand beside the planes, in their part: with `keep_channels`, all
/// that a flat part has but for the earlier products that give way.
/// Errors: ExitCode::input for channels that cannot be read or downsampled.
std::vector<KeptChannel> kept_channels(const ExrOutput& output);

/// All channels of a part. Errors: those of kept_channels().
std::vector<KeptChannel> all_channels(const ExrOutput& output, const ExrPart& part);

/// Where OpenEXR finds the pixels of channels that are all over the window `known`.
Imf::FrameBuffer slices_of(const std::vector<KeptChannel>& channels, const Window& known);

/// Throws ExitCode::input for a part that is kept and cannot be downsampled.
void check_downsampling(const ExrOutput& output, const ExrPart& part);

}  // namespace ssdo
