// SPDX-License-Identifier: Apache-2.0
#include "scene/layers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "error.h"
#include "scene/layer_names.h"
#include "sequence.h"

namespace ssdo {
namespace {

constexpr std::array<std::string_view, kRoleCount> kRoleNames = {
    "position", "normal",   "albedo",  "depth",     "alpha",
    "beauty",   "radiance", "ambient", "roughness", "motion"};

std::string_view last_segment(std::string_view path) {
  const auto dot = path.rfind('.');
  return dot == std::string_view::npos ? path : path.substr(dot + 1);
}

/// The channels of a part that share a path up to the last dot, by lower-case component.
struct Group {
  int file = 0, part = 0;
  std::string name;       ///< part and layer, for messages and --aov
  std::string layer;      ///< path without the part's name
  bool only_part = true;  ///< of its file
  std::map<std::string, ExrChannel> components;

  const ExrChannel* find(std::string_view component) const {
    const auto it = components.find(std::string(component));
    return it == components.end() ? nullptr : &it->second;
  }
};

/// "part.layer", unless the layer begins with the part's name as Blender and Nuke write it.
std::string qualified(const std::string& part, const std::string& layer) {
  if (part.empty() || layer == part || layer.starts_with(part + ".")) return layer;
  return layer.empty() ? part : part + "." + layer;
}

std::vector<Group> group_channels(const std::vector<const ExrReader*>& files,
                                  const std::string& only_part) {
  std::vector<Group> groups;
  for (std::size_t f = 0; f < files.size(); ++f) {
    for (const ExrPart& part : files[f]->parts()) {
      if (part.deep) continue;
      if (f == 0 && !only_part.empty() && part.name != only_part &&
          std::to_string(part.index) != only_part) {
        continue;
      }
      std::map<std::string, Group> by_layer;
      for (const ExrChannel& channel : part.channels) {
        if (channel.x_sampling != 1 || channel.y_sampling != 1) continue;
        const auto dot = channel.name.rfind('.');
        const std::string layer = dot == std::string::npos ? "" : channel.name.substr(0, dot);
        Group& group = by_layer[layer];
        group.file = int(f);
        group.part = part.index;
        group.layer = layer;
        group.only_part = files[f]->parts().size() == 1;
        group.name = qualified(part.name, layer);
        group.components[lower(last_segment(channel.name))] = channel;
      }
      for (auto& [layer, group] : by_layer) groups.push_back(std::move(group));
    }
  }
  return groups;
}

/// The group's channels for the role, or none if the components do not fit.
std::optional<Layer> as_layer(const Group& group, Role role) {
  // The Z of X, Y, Z is a coordinate, not a depth.
  if (role == Role::depth && group.find("x") && group.find("y")) return std::nullopt;
  for (const Components& set : component_sets(role)) {
    if (role != Role::normal && set[0] == "nx") continue;
    Layer layer{group.file, group.part, group.name, {}, false, false};
    for (const std::string& component : set) {
      if (const ExrChannel* channel = group.find(component)) {
        layer.channels.push_back(channel->name);
        layer.half |= channel->type == Imf::HALF;
      }
    }
    if (layer.channels.size() == set.size()) return layer;
  }
  return std::nullopt;
}

/// A single channel as a scalar layer: a bare "Z", or "depth" without a component.
Layer scalar_layer(const Group& group, const ExrChannel& channel) {
  return {group.file,
          group.part,
          qualified(group.name, channel.name),
          {channel.name},
          channel.type == Imf::HALF,
          false};
}

/// What a group may be called: its whole path, its path within the part, and their last segments.
/// Channels without a layer are called after their part, unless there is no other part.
std::vector<std::string> keys_of(const Group& group) {
  const std::string full = normalise(group.name), own = normalise(group.layer);
  std::vector<std::string> keys = {full, std::string(last_segment(full))};
  if (!own.empty()) keys.insert(keys.end(), {own, std::string(last_segment(own))});
  if (own.empty() && group.only_part) keys.push_back(own);
  return keys;
}

struct Candidate {
  std::size_t rank = 0;
  Layer layer;
};

std::vector<Candidate> candidates_of(Role role, const std::vector<Group>& groups) {
  std::vector<Candidate> found;
  for (const Group& group : groups) {
    if (group.file != 0) continue;
    // Blender's has four; two of such a name may be anything.
    if (role == Role::motion && !group.find("w")) continue;
    const std::vector<std::string> keys = keys_of(group);
    const auto layer = as_layer(group, role);
    const bool bare_nxnynz =
        role == Role::normal && layer && lower(last_segment(layer->channels[0])) == "nx";
    if (const auto rank = bare_nxnynz ? std::optional<std::size_t>(0) : rank_of(role, keys);
        rank && layer) {
      found.push_back({*rank, *layer});
      continue;
    }
    // Beauty's A is the alpha of the frame.
    if (role == Role::alpha && layer) {
      if (const auto rank = rank_of(Role::beauty, keys)) found.push_back({100 + *rank, *layer});
    }
    if (component_sets(role)[0].size() == 1 && role != Role::alpha &&
        !(role == Role::depth && group.find("x") && group.find("y"))) {
      for (const auto& [component, channel] : group.components) {
        if (const auto rank = rank_of(role, {normalise(component)})) {
          found.push_back({*rank, scalar_layer(group, channel)});
        }
      }
    }
  }
  return found;
}

std::string list_names(const std::vector<Candidate>& candidates) {
  std::vector<std::string> names;
  for (const auto& c : candidates) names.push_back("'" + c.layer.name + "'");
  return fmt::format("{}", fmt::join(names, ", "));
}

std::optional<Layer> find_by_name(Role role, const std::vector<Group>& groups,
                                  const std::string& file) {
  std::vector<Candidate> all = candidates_of(role, groups), best;
  for (const Candidate& c : all) {
    if (!best.empty() && c.rank > best[0].rank) continue;
    if (!best.empty() && c.rank < best[0].rank) best.clear();
    best.push_back(c);
  }
  if (best.empty()) return std::nullopt;
  if (best.size() > 1) {
    throw Error(ExitCode::layer,
                fmt::format("{}: {} layers could be {}: {}; choose one with --aov {}=LAYER", file,
                            best.size(), role_name(role), list_names(best), role_name(role)));
  }
  return best[0].layer;
}

/// The layers whose name is `wanted`: exactly, else with the case ignored.
std::vector<Layer> layers_named(const std::string& wanted, Role role, int file,
                                const std::vector<Group>& groups) {
  std::vector<Layer> exact, loose;
  const auto note = [&](const std::string& name, const Layer& layer) {
    if (name == wanted) exact.push_back(layer);
    if (lower(name) == lower(wanted)) loose.push_back(layer);
  };
  const bool scalar = component_sets(role)[0].size() == 1;
  for (const Group& group : groups) {
    if (group.file != file) continue;
    if (const auto layer = as_layer(group, role)) {
      note(group.name, *layer);
      if (group.layer != group.name) note(group.layer, *layer);
    }
    for (const auto& [component, channel] : group.components) {
      if (scalar) note(channel.name, scalar_layer(group, channel));
    }
  }
  return exact.empty() ? loose : exact;
}

/// Nothing has the name of a request: it was meant as FILE:LAYER if what stands before the last
/// colon can only be a file.
void refuse_missing_file(const LayerRequest& request) {
  const std::string file = request.layer.substr(0, request.layer.rfind(':'));
  const bool is_name = lower(file).ends_with(".exr") || file.find('/') != file.npos;
  if (!request.file.empty() || file == request.layer || !is_name) return;
  throw Error(ExitCode::input, fmt::format("{}: does not exist; check --aov {}={}", file,
                                           role_name(request.role), request.layer));
}

Layer find_requested(const LayerRequest& request, const std::vector<const ExrReader*>& files,
                     const std::vector<Group>& groups) {
  int file = 0;
  for (std::size_t f = 1; f < files.size() && !request.file.empty(); ++f) {
    if (files[f]->path() == request.file) file = int(f);
  }
  const auto found = layers_named(request.layer, request.role, file, groups);
  if (found.size() == 1) {
    Layer layer = found[0];
    layer.by_request = true;
    return layer;
  }
  if (found.empty()) refuse_missing_file(request);
  std::vector<std::string> names;
  for (const Group& group : groups) {
    if (group.file == file && as_layer(group, request.role))
      names.push_back("'" + group.name + "'");
  }
  throw Error(
      ExitCode::layer,
      fmt::format("{}: {} layer '{}' with channels for {}; the file has {}",
                  files[std::size_t(file)]->path().string(), found.empty() ? "no" : "more than one",
                  request.layer, role_name(request.role),
                  names.empty() ? "none that fits" : fmt::format("{}", fmt::join(names, ", "))));
}

}  // namespace

std::string_view role_name(Role role) { return kRoleNames[std::size_t(role)]; }

std::optional<Role> role_from_name(std::string_view name) {
  for (std::size_t i = 0; i < kRoleCount; ++i) {
    if (kRoleNames[i] == name) return Role(i);
  }
  return std::nullopt;
}

LayerRequest parse_layer_request(const std::string& text) {
  const auto equals = text.find('=');
  const auto role = role_from_name(text.substr(0, equals));
  if (equals == std::string::npos || !role || equals + 1 == text.size()) {
    throw Error(ExitCode::usage,
                fmt::format("--aov {}: expected ROLE=LAYER or ROLE=FILE:LAYER with ROLE one of {}",
                            text, fmt::join(kRoleNames, ", ")));
  }
  LayerRequest request{*role, "", text.substr(equals + 1)};
  // A colon may stand in a layer's name: it ends a file's where that is a file, or a sequence.
  const auto colon = request.layer.rfind(':');
  if (colon == std::string::npos) return request;
  const std::string file = request.layer.substr(0, colon);
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  if ((exists(status) && !is_directory(status)) || is_pattern(file)) {
    request.file = file;
    request.layer = request.layer.substr(colon + 1);
  }
  return request;
}

LayerTable find_layers(const std::vector<const ExrReader*>& files,
                       const std::vector<LayerRequest>& requests, const std::string& only_part,
                       const std::vector<Role>& unused) {
  const std::string frame = files[0]->path().string();
  const auto groups = group_channels(files, only_part);
  if (groups.empty()) {
    const auto& parts = files[0]->parts();
    if (!only_part.empty()) {
      std::vector<std::string> names;
      for (const auto& part : parts) names.push_back(fmt::format("{} '{}'", part.index, part.name));
      throw Error(ExitCode::layer, fmt::format("{}: no flat part '{}'; the file has {}", frame,
                                               only_part, fmt::join(names, ", ")));
    }
    throw Error(
        ExitCode::input,
        fmt::format("{}: holds deep images only; ssdo reads flat ones: flatten it first", frame));
  }
  LayerTable table;
  for (const LayerRequest& request : requests) {
    table[request.role] = find_requested(request, files, groups);
  }
  for (std::size_t i = 0; i < kRoleCount; ++i) {
    const bool used = std::find(unused.begin(), unused.end(), Role(i)) == unused.end();
    if (used && !table.layers[i]) table.layers[i] = find_by_name(Role(i), groups, frame);
  }
  return table;
}

}  // namespace ssdo
