// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scene/layers/layers.h"

namespace ssdo {

/// What the headers of a frame's files hold, whether or not it makes a frame.
struct Listing {
  std::string text;     ///< a line per part with its windows, and one per layer with its channels
  nlohmann::json json;  ///< "file" and its "parts"; "other_files" where --aov names some
};

/// Lists the files of a frame. One that cannot be opened is left out: it has no parts.
Listing list_layers(const std::string& input, const std::vector<LayerRequest>& aovs);

/// The parts of a file with their windows and channels.
nlohmann::json parts_json(const ExrReader& file);

/// x0, y0, x1, y1, the last two inclusive.
nlohmann::json window_json(const Window& window);

}  // namespace ssdo
