// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

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
/// `albedo:premultiplied`, which states how alpha is in it, and is `light:NAME` for what a lamp
/// gave.
struct LayerRequest {
  Role role = Role::position;
  std::string file;  ///< empty: the frame itself
  std::string layer;
  std::optional<bool> premultiplied = {};
  std::string light = {};  ///< its name, for Role::light
};

/// The layers of a frame by role.
struct LayerTable {
  std::array<std::optional<Layer>, kRoleCount> layers;  ///< none for Role::light
  std::map<std::string, Layer> lights;  ///< of Role::light, by the name of the light

  const std::optional<Layer>& operator[](Role role) const { return layers[std::size_t(role)]; }
  std::optional<Layer>& operator[](Role role) { return layers[std::size_t(role)]; }

  /// All that have a role.
  std::vector<const Layer*> all(Role role) const {
    std::vector<const Layer*> found;
    if (const auto& one = (*this)[role]) found.push_back(&*one);
    if (role == Role::light)
      for (const auto& [name, layer] : lights) found.push_back(&layer);
    return found;
  }
};

}  // namespace ssdo
