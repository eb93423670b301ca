// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ssdo {

/// What a layer is used as; roles.cpp has a row for each. Layers are searched for in this order.
enum class Role {
  position,
  normal,
  albedo,
  depth,
  alpha,
  beauty,
  radiance,
  ambient,
  specular,
  light,
  roughness,
  specular_color,
  motion,
};
inline constexpr std::size_t kRoleCount = std::size_t(Role::motion) + 1;

/// The last words of the names of a layer's channels, in lower case and in the order of the vector
/// or colour that they make: {"x", "y", "z"} stands for P.X, P.Y and P.Z.
using Components = std::vector<std::string>;

/// What there is to know of a role.
struct RoleRow {
  std::string_view name;  ///< in options and messages

  /// Names of layers that may take the role, best first, as normalise() leaves them. `*` stands for
  /// anything, "" for a layer without a name, "nxnynz" for three components without a layer. A name
  /// with a dot is compared with the whole path of a layer, one without with its last segment too.
  /// Empty: the role is filled on request only.
  std::vector<std::string> layers;

  /// The sets of components that its channels may be, best first. All are of one size.
  std::vector<Components> components;

  /// What becomes of surfaces outside the layer's data window; ends a sentence of which they are
  /// the subject.
  std::string_view outside;

  /// Whether such pixels count as background because of that.
  bool background_outside = false;
};

const RoleRow& row_of(Role role);

std::string_view role_name(Role role);

/// The names of all roles, in the order of Role.
std::vector<std::string_view> role_names();

std::optional<Role> role_from_name(std::string_view name);

}  // namespace ssdo
