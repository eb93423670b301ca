// SPDX-License-Identifier: Apache-2.0
#include "scene/layers/names.h"

#include <fnmatch.h>

#include <array>
#include <cctype>

namespace ssdo {
namespace {

/// Names in order of preference, normalised: lower case, no spaces, underscores or dashes; `*`
/// stands for anything. A name with a dot is compared with the whole path of a layer, one without
/// with its last segment too. "" is a layer without a name, "nxnynz" three components without one.
/// Plain `diffuse` is missing on purpose (it is lit), `pref` and `rest` too (another space), `mist`
/// too (no distance). `radiance` and `ambient` have no name that could be trusted: they are used on
/// request only. So is motion of other renderers than Blender, whose units and signs differ.
const std::vector<std::string>& known_names(Role role) {
  static const std::array<std::vector<std::string>, kRoleCount> names = {{
      {"pworld", "p.world", "p", "position", "worldposition", "worldpos", "posw", "wp", "ppass",
       "cgeometryworldposition", "*movierenderqueueworldposition", "pxpypz"},
      {"nxnynz", "nworld", "n.world", "n", "normal", "normals", "nn", "shnormal", "normw",
       "worldnormal", "ns", "vraynormals", "cgeometrynormalsshading", "bumpnormals",
       "denoisingnormal"},
      {"albedo", "diffusealbedo", "diffcol", "diffusecolor", "diffusefilter", "vraydiffusefilter",
       "cshadingalbedo", "cshadingsourcecolor", "diffuseopacity", "denoisealbedo",
       "denoisingalbedo", "basecolor"},
      {"depth", "z", "pz", "lineardepth", "linearz", "zfiltered", "*worlddepth", "zdepth",
       "vrayzdepth", "cgeometryzdepth"},
      {"alpha"},
      {"", "rgba", "beauty", "combined", "ci", "c", "finalimage*beauty"},
      {},
      {},
      {"roughness", "specularroughness"},
      {"vector"},
  }};
  return names[std::size_t(role)];
}

}  // namespace

std::string lower(std::string_view text) {
  std::string out;
  for (char c : text) out += char(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::string normalise(std::string_view text) {
  std::string out;
  for (char c : lower(text)) {
    if (c != ' ' && c != '_' && c != '-') out += c;
  }
  return out;
}

std::optional<std::size_t> rank_of(Role role, const std::vector<std::string>& keys) {
  const auto& names = known_names(role);
  for (std::size_t rank = 0; rank < names.size(); ++rank) {
    for (const std::string& key : keys) {
      if (fnmatch(names[rank].c_str(), key.c_str(), 0) == 0) return rank;
    }
  }
  return std::nullopt;
}

const std::vector<Components>& component_sets(Role role) {
  static const std::vector<Components> position = {
      {"x", "y", "z"}, {"r", "g", "b"}, {"red", "green", "blue"}, {"px", "py", "pz"}};
  static const std::vector<Components> normal = {
      {"x", "y", "z"}, {"r", "g", "b"}, {"red", "green", "blue"}, {"nx", "ny", "nz"}};
  static const std::vector<Components> color = {{"r", "g", "b"}, {"red", "green", "blue"}};
  static const std::vector<Components> depth = {{"z"}, {"v"}, {"y"}, {"r"}, {"t"}, {"depth"}};
  // A single value, or one that a renderer wrote as grey or into the first of three.
  static const std::vector<Components> scalar = {{"y"}, {"v"}, {"r"}, {"red"}, {"x"}};
  static const std::vector<Components> alpha = {{"a"}, {"alpha"}};
  static const std::vector<Components> motion = {
      {"x", "y"}, {"r", "g"}, {"red", "green"}, {"u", "v"}};
  switch (role) {
    case Role::position:
      return position;
    case Role::normal:
      return normal;
    case Role::depth:
      return depth;
    case Role::alpha:
      return alpha;
    case Role::roughness:
      return scalar;
    case Role::motion:
      return motion;
    default:
      return color;
  }
}

}  // namespace ssdo
