// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/layers/groups.h"
#include "scene/layers/layer_table.h"

namespace ssdo {

/// A layer that could take a role by its name; a smaller rank is a better name.
struct Candidate {
  std::size_t rank = 0;
  Layer layer;
  std::string view;
};

/// The group's channels for the role, or none if its components do not fit.
std::optional<Layer> as_layer(const LayerGroup& group, Role role);

/// The layers with the best name for the role: several where they have an equal claim.
std::vector<Candidate> best_candidates(Role role, const std::vector<LayerGroup>& groups);

/// What a request calls the layer: its name, or "rgba" for channels without a layer.
std::string name_for_request(const LayerGroup& group);

/// The layers whose name is `wanted`: exactly, else with the case ignored. Channels without a layer
/// are "rgba". Products of an earlier run of ssdo are named last.
std::vector<Layer> layers_named(const std::string& wanted, Role role,
                                const std::vector<LayerGroup>& groups);

}  // namespace ssdo
