// SPDX-License-Identifier: Apache-2.0
#include "scene/layers/candidates.h"

#include <set>

#include "scene/layers/names.h"

namespace ssdo {
namespace {

/// V-Ray puts this before the name that the user gave an ExtraTex element.
constexpr std::string_view kExtraTexture = "vrayextratex";

/// What channels without a layer are called in requests.
const std::string kNoLayer = "rgba";

std::string last_segment(const std::string& path) { return split_channel(path).second; }

/// Whether the channel is the z of three that end in x, y and z: a coordinate, not a depth.
bool is_coordinate(const LayerGroup& group, const std::string& component) {
  if (!component.ends_with('z')) return false;
  const std::string stem = component.substr(0, component.size() - 1);
  return group.find(stem + "x") && group.find(stem + "y");
}

/// A single channel as a scalar layer: a bare "Z", or "depth" without a component.
Layer scalar_layer(const LayerGroup& group, const ExrChannel& channel) {
  const std::string component = last_segment(channel.name),
                    name = group.name.empty() ? component : group.name + "." + component;
  return {group.file, group.part, name, {channel.name}, channel.type == Imf::HALF, false};
}

/// What a layer may be called: its whole path, its path within the part, their last segments, and
/// its components ("nxnynz"). Channels without a layer are called after their part, unless there is
/// no other part. What has no name but its view's ("right.R") is the rgba of that view.
std::vector<std::string> keys_of(const LayerGroup& group, const Layer& layer) {
  const std::string full = normalise(group.path), own = normalise(group.own_path);
  std::vector<std::string> keys = {full, last_segment(full)};
  if (full.empty() && !group.name.empty()) keys = {"rgba"};
  if (!own.empty()) keys.insert(keys.end(), {own, last_segment(own)});
  if (group.layer.empty() && group.only_part) keys.push_back("");
  for (std::size_t i = 0, count = keys.size(); i < count; ++i) {
    if (keys[i].starts_with(kExtraTexture)) keys.push_back(keys[i].substr(kExtraTexture.size()));
  }
  std::string components;
  for (const std::string& channel : layer.channels) components += lower(last_segment(channel));
  keys.push_back(components);
  return keys;
}

bool is_scalar(Role role) { return row_of(role).components[0].size() == 1; }

/// Candidates from single channels of a group, such as a bare "Z".
void add_scalars(Role role, const LayerGroup& group, std::vector<Candidate>& found) {
  for (const auto& [component, channel] : group.components) {
    if (role == Role::depth && is_coordinate(group, component)) continue;
    if (const auto rank = rank_of(role, {normalise(component)}))
      found.push_back({*rank, scalar_layer(group, channel), group.view});
  }
}

/// The group's channels by every set of components that they hold: R G B and Px Py Pz side by side.
std::vector<Layer> fitting_layers(const LayerGroup& group, Role role) {
  std::vector<Layer> layers;
  for (const Components& set : row_of(role).components) {
    if (role == Role::depth && is_coordinate(group, set[0])) continue;
    Layer layer{group.file, group.part, group.name, {}, false, false};
    for (const std::string& component : set) {
      if (const ExrChannel* channel = group.find(component)) {
        layer.channels.push_back(channel->name);
        layer.half |= channel->type == Imf::HALF;
      }
    }
    if (layer.channels.size() == set.size()) layers.push_back(layer);
  }
  return layers;
}

void add_candidates(Role role, const LayerGroup& group, std::vector<Candidate>& found) {
  // Blender's Vector has four channels; two channels of that name are not trusted.
  if (role == Role::motion && !group.find("w")) return;
  for (const Layer& layer : fitting_layers(group, role)) {
    const std::vector<std::string> keys = keys_of(group, layer);
    auto rank = rank_of(role, keys);
    // Beauty's A is the alpha of the frame.
    if (!rank && role == Role::alpha && (rank = rank_of(Role::beauty, keys))) *rank += 100;
    if (!rank) continue;
    found.push_back({*rank, layer, group.view});
    return;
  }
  if (is_scalar(role) && role != Role::alpha) add_scalars(role, group, found);
}

/// layers_named() of products of an earlier run, or of all other groups.
std::vector<Layer> layers_named(const std::string& wanted, Role role,
                                const std::vector<LayerGroup>& groups, bool by_earlier_run) {
  std::vector<Layer> exact, loose;
  const auto note = [&](const std::set<std::string>& names, const Layer& layer) {
    bool same = false, similar = false;
    for (const std::string& name : names) {
      same |= name == wanted;
      similar |= lower(name) == lower(wanted);
    }
    if (same) exact.push_back(layer);
    if (similar) loose.push_back(layer);
  };
  for (const LayerGroup& group : groups) {
    if (group.by_earlier_run != by_earlier_run) continue;
    const auto layer = as_layer(group, role);
    const std::set<std::string> names = {group.name, group.layer, group.path, group.own_path,
                                         group.path.empty() ? kNoLayer : group.path};
    if (layer) note(names, *layer);
    if (!is_scalar(role)) continue;
    for (const auto& [component, channel] : group.components) {
      const Layer scalar = scalar_layer(group, channel);
      // A part "Z" with a channel "Z" is one layer, whichever of them is meant.
      const bool noted = layer && layer->channels == scalar.channels && group.name == wanted;
      const std::string own = last_segment(channel.name);
      if (!noted) note({group.layer.empty() ? own : group.layer + "." + own, scalar.name}, scalar);
    }
  }
  return exact.empty() ? loose : exact;
}

}  // namespace

std::optional<Layer> as_layer(const LayerGroup& group, Role role) {
  const std::vector<Layer> layers = fitting_layers(group, role);
  return layers.empty() ? std::nullopt : std::optional(layers[0]);
}

std::vector<Candidate> best_candidates(Role role, const std::vector<LayerGroup>& groups) {
  std::vector<Candidate> all, best;
  for (const LayerGroup& group : groups)
    if (!group.by_earlier_run) add_candidates(role, group, all);
  for (const Candidate& c : all) {
    if (!best.empty() && c.rank > best[0].rank) continue;
    if (!best.empty() && c.rank < best[0].rank) best.clear();
    best.push_back(c);
  }
  return best;
}

std::string name_for_request(const LayerGroup& group) {
  return group.name.empty() ? kNoLayer : group.name;
}

std::vector<Layer> layers_named(const std::string& wanted, Role role,
                                const std::vector<LayerGroup>& groups) {
  const std::vector<Layer> found = layers_named(wanted, role, groups, false);
  return found.empty() ? layers_named(wanted, role, groups, true) : found;
}

}  // namespace ssdo
