// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>

namespace ssdo {

/// Numbers of frames by their places in a run.
using FramesByPlace = std::map<std::size_t, int>;

/// "frame 3", "frames 3 to 24, 30". Frames whose places follow each other are joined; after eight
/// ranges, the rest is counted: "frames 1, 3, ... and 12 more". Not for no frames.
std::string text_of(const FramesByPlace& frames);

}  // namespace ssdo
