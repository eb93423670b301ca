// SPDX-License-Identifier: Apache-2.0
//
// The table of roles. A new role is a row here, with its name in Role, a member of GBuffer, and the
// line of read_gbuffer.cpp that reads it.
#include "scene/layers/roles.h"

#include <array>

namespace ssdo {
namespace {

const std::vector<Components> kColor = {{"r", "g", "b"}, {"red", "green", "blue"}};

/// Vectors may be stored as colours, or in three channels that are named in full.
std::vector<Components> vector_sets(const Components& in_full) {
  return {{"x", "y", "z"}, {"r", "g", "b"}, {"red", "green", "blue"}, in_full};
}

/// Plain `diffuse` is not among the names of albedo, since it is lit; `pref` and `rest` not among
/// those of position, since they are in another space; `mist` not among those of depth, since it is
/// no distance. `radiance`, `ambient`, `specular` and `light` have no name that could be trusted: a
/// specular layer usually has the highlights of lamps too. `specular-color` has none, since
/// renderers write tints, weights and F0 under the same names. Nor has motion of other renderers
/// than Blender, whose units and signs differ.
const std::array<RoleRow, kRoleCount>& table() {
  static const std::array<RoleRow, kRoleCount> rows = {{
      {.name = "position",
       .layers = {"pworld",
                  "p.world",
                  "p",
                  "position",
                  "worldposition",
                  "worldpos",
                  "posw",
                  "wp",
                  "ppass",
                  "cgeometryworldposition",
                  "*movierenderqueueworldposition",
                  "pxpypz",
                  "wpos",
                  "wpp",
                  "pw",
                  "worldp",
                  "positionworld",
                  "posworld",
                  "worldspaceposition",
                  "pos",
                  "p.camera"},
       .components = vector_sets({"px", "py", "pz"}),
       .outside = "are black in it"},
      {.name = "normal",
       .layers = {"nxnynz",
                  "nworld",
                  "n.world",
                  "n",
                  "normal",
                  "normals",
                  "nn",
                  "shnormal",
                  "normw",
                  "worldnormal",
                  "ns",
                  "vraynormals",
                  "cgeometrynormalsshading",
                  "bumpnormals",
                  "nw",
                  "worldn",
                  "normalworld",
                  "worldnormals",
                  "worldspacenormal",
                  "nrm",
                  "n.camera",
                  "denoisingnormal"},
       .components = vector_sets({"nx", "ny", "nz"}),
       .outside = "have their normal rebuilt from P"},
      {.name = "albedo",
       .layers = {"albedo", "diffusealbedo", "diffcol", "diffusecolor", "diffusefilter",
                  "vraydiffusefilter", "cshadingalbedo", "cshadingsourcecolor", "diffuseopacity",
                  "denoisealbedo", "denoisingalbedo", "basecolor", "alb", "diffcolor"},
       .components = kColor,
       .outside = "are black in it"},
      {.name = "depth",
       .layers = {"lineardepth", "linearz", "depth", "z", "ray:hitpz", "pz", "zfiltered",
                  "*worlddepth", "ray:hitdist", "zdepth", "vrayzdepth", "cgeometryzdepth",
                  "znormalized", "znormalizedinverted"},
       .components = {{"z"}, {"v"}, {"y"}, {"r"}, {"t"}, {"depth"}},
       .outside = "count as background",
       .background_outside = true},
      {.name = "alpha",
       .layers = {"alpha"},
       .components = {{"a"}, {"alpha"}},
       .outside = "count as background",
       .background_outside = true},
      {.name = "beauty",
       .layers = {"", "rgba", "beauty", "combined", "ci", "c", "finalimage*beauty"},
       .components = kColor,
       .outside = "are black in it"},
      {.name = "radiance", .layers = {}, .components = kColor, .outside = "are black in it"},
      {.name = "ambient", .layers = {}, .components = kColor, .outside = "are black in it"},
      {.name = "specular", .layers = {}, .components = kColor, .outside = "are black in it"},
      // One for each lamp that is named.
      {.name = "light", .layers = {}, .components = kColor, .outside = "are black in it"},
      // One value, or one that a renderer wrote as grey or into the first of three channels.
      {.name = "roughness",
       .layers = {"roughness", "specularroughness"},
       .components = {{"y"}, {"v"}, {"r"}, {"red"}, {"x"}},
       .outside = "have a roughness of 0"},
      // A colour, or one value for all channels.
      {.name = "specular-color",
       .layers = {},
       .components = {{"r", "g", "b"}, {"red", "green", "blue"}, {"y", "y", "y"}, {"v", "v", "v"}},
       .outside = "mirror nothing along their normal"},
      {.name = "motion",
       .layers = {"vector"},
       .components = {{"x", "y"}, {"r", "g"}, {"red", "green"}, {"u", "v"}},
       .outside = "have no history"},
  }};
  return rows;
}

}  // namespace

const RoleRow& row_of(Role role) { return table()[std::size_t(role)]; }

std::string_view role_name(Role role) { return row_of(role).name; }

std::vector<std::string_view> role_names() {
  std::vector<std::string_view> names;
  for (const RoleRow& row : table()) names.push_back(row.name);
  return names;
}

std::optional<Role> role_from_name(std::string_view name) {
  for (std::size_t i = 0; i < kRoleCount; ++i) {
    if (table()[i].name == name) return Role(i);
  }
  return std::nullopt;
}

}  // namespace ssdo
