// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "scene/view.h"

namespace ssdo {

// Lists what the headers of a frame's files hold, whether or not `ssdo` can use it.

/// Opens the files of a frame, without those that cannot be opened.
std::deque<ExrReader> open_files(const FrameFiles& files);

/// A line per part with its windows, and one per layer with its channels.
std::string list_layers(const std::deque<ExrReader>& files);

/// "file" and its "parts"; "other_files" where there are some.
nlohmann::json listing_json(const std::string& input, const std::deque<ExrReader>& files);

/// The parts of a file with their windows and channels.
nlohmann::json parts_json(const ExrReader& file);

/// x0, y0, x1, y1, the last two inclusive.
nlohmann::json window_json(const Window& window);

}  // namespace ssdo
