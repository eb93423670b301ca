// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "io/exr/exr_reader.h"
#include "scene/layers/layer_table.h"
#include "scene/layers/roles.h"

namespace ssdo {

/// Parses the value of --aov. Errors: ExitCode::usage.
LayerRequest parse_layer_request(const std::string& text);

/// Finds the layer of every role by the names that renderers give them (roles.cpp).
/// A request wins over names. `files[0]` is the frame; a request with a file refers to the file of
/// the same path in `files`. All layers are of the view of the position, or else of the depth.
/// `only_part` is empty, or a part by name or number, which the other parts of its view complete,
/// or a view. With `view`, one of kEyes, all layers are of this view or of none, and the position
/// or depth of this view. The roles in `unused` are filled on request only. Errors: ExitCode::layer
/// when two layers have an equal claim, or a requested one does not exist; the message lists the
/// candidates.
LayerTable find_layers(const std::vector<const ExrReader*>& files,
                       const std::vector<LayerRequest>& requests, const std::string& only_part,
                       const std::vector<Role>& unused = {}, const std::string& view = "");

/// Throws ExitCode::layer where the table has neither position nor depth. `view` is as of
/// find_layers; `advice` ends the message.
void require_position(const LayerTable& table, const ExrReader& frame, const std::string& view,
                      const std::string& advice);

/// The frame, then every file that `aovs` name, each once.
std::vector<std::string> files_of_frame(const std::string& input,
                                        const std::vector<LayerRequest>& aovs);

}  // namespace ssdo
