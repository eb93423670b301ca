// SPDX-License-Identifier: Apache-2.0
#include "scene/layers/advice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "scene/layers/candidates.h"
#include "scene/layers/names.h"

namespace ssdo {
namespace {

constexpr std::size_t kMostNames = 8;  ///< of layers, in a message of one line

/// Whether the layer has a good name for another role.
bool is_known(const LayerGroup& group) {
  const auto is_one = [&](Role role) { return !best_candidates(role, {group}).empty(); };
  return is_one(Role::normal) || is_one(Role::albedo) || is_one(Role::beauty);
}

bool contains(const LayerGroup& group, std::string_view word) {
  return normalise(group.path).find(word) != std::string::npos;
}

/// The layers that the role could be in, without those that are known for something else.
std::vector<LayerGroup> unknown_layers(Role role, const std::vector<LayerGroup>& groups) {
  std::vector<LayerGroup> unknown;
  for (const LayerGroup& group : groups) {
    if (!group.name.empty() && as_layer(group, role) && !is_known(group)) unknown.push_back(group);
  }
  return unknown;
}

/// Words in the names of layers that may be meant for a role, and in those of others.
struct Wording {
  Role role;
  std::vector<std::string_view> like, unlike;
};

const std::vector<Wording>& wordings() {
  static const std::vector<Wording> rows = {
      {Role::position,
       {"pos", "point", "worldp", "pworld", "wpp", "xyz"},
       {"object", "rest", "pref", "expos", "compos"}},
      {Role::normal,
       {"normal", "nrm", "worldn", "nworld"},
       {"object", "rest", "nref", "noice", "tangent"}},
      {Role::albedo,
       {"alb", "basecol", "diffcol", "diffusecol", "diffusefilter"},
       {"specular", "coat", "sheen", "mse", "variance"}}};
  return rows;
}

bool is_like(const Wording& wording, const LayerGroup& group) {
  const auto has = [&](std::string_view word) { return contains(group, word); };
  return std::any_of(wording.like.begin(), wording.like.end(), has) &&
         std::none_of(wording.unlike.begin(), wording.unlike.end(), has);
}

}  // namespace

std::string hint_at(Role role, const std::vector<LayerGroup>& groups) {
  std::vector<std::string> likely;
  for (const LayerGroup& group : unknown_layers(role, groups)) {
    if (role == Role::position && contains(group, "samplerinfo")) {
      return fmt::format("if '{0}' was rendered with type Point, say --aov \"position={0}\"",
                         group.name);
    }
    for (const Wording& wording : wordings())
      if (wording.role == role && is_like(wording, group)) likely.push_back(group.name);
  }
  if (likely.size() != 1) return "";
  return fmt::format("if '{0}' is the {1}, say --aov \"{1}={0}\"", likely[0], role_name(role));
}

std::string advice_on_position(const std::vector<LayerGroup>& groups) {
  const std::string hint = hint_at(Role::position, groups);
  if (!hint.empty()) return hint;
  const bool one_pass = groups.size() == 1 && groups[0].name.empty();
  if (one_pass && as_layer(groups[0], Role::position))
    return "if its one layer is the position, say --aov position=rgba";
  std::vector<std::string> names;
  for (const LayerGroup& group : unknown_layers(Role::position, groups))
    names.push_back(group.name);
  const std::string asked = "name one with --aov position=LAYER or --aov depth=LAYER";
  if (names.empty()) return asked;
  const bool more = names.size() > kMostNames;
  names.resize(std::min(names.size(), kMostNames));
  return fmt::format("{}; channels for a position are in '{}'{}", asked, fmt::join(names, "', '"),
                     more ? " and others" : "");
}

}  // namespace ssdo
