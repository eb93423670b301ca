// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "io/exr/exr_reader.h"
#include "scene/layers/roles.h"

namespace ssdo {

/// A layer that was chosen for a role: three channels for vectors and colours, two for motion in
/// the picture, one for scalars.
struct Layer {
  int file = 0;  ///< 0 is the frame itself, others follow in the order of --aov
  int part = 0;
  std::string name;                        ///< as the file spells it, with the part in front
  std::vector<std::string> channels;       ///< full channel names, in the order x y z or r g b
  bool half = false;                       ///< whether a channel is stored with 16 bits
  bool by_request = false;                 ///< by --aov, not found by its name
  std::optional<bool> premultiplied = {};  ///< by alpha, where --aov says it
};

/// One `--aov ROLE=LAYER` or `--aov ROLE=FILE:LAYER`. ROLE may be `albedo:straight` or
/// `albedo:premultiplied`, which states how alpha is in it.
struct LayerRequest {
  Role role = Role::position;
  std::string file;  ///< empty: the frame itself
  std::string layer;
  std::optional<bool> premultiplied = {};
};

/// The layers of a frame by role.
struct LayerTable {
  std::array<std::optional<Layer>, kRoleCount> layers;

  const std::optional<Layer>& operator[](Role role) const { return layers[std::size_t(role)]; }
  std::optional<Layer>& operator[](Role role) { return layers[std::size_t(role)]; }
};

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
