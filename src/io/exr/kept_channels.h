// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfFrameBuffer.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "io/exr/exr_output.h"

namespace ssdo {

/// A channel of the input on its way into the output, at the output's size.
struct KeptChannel {
  std::string name;  ///< in the output
  StoredChannel stored;
};

/// The products that earlier runs of ssdo left among the channels of a part, by their names, and
/// where they moved the part's own channel of that name; empty: there was none.
using EarlierProducts = std::map<std::string, std::string>;

/// As the attribute kEarlierProducts says, or by the names "input.NAME" where ssdo wrote none.
EarlierProducts earlier_products(const ExrPart& part);

/// A JSON object of an EarlierProducts; null: there was no such channel.
inline constexpr std::string_view kEarlierProducts = "ssdo/channels";

/// What the header of an output says of its products for later runs.
std::string products_text(const ExrOutput& output, const std::vector<KeptChannel>& kept);

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
