// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace ssdo {

/// What the composite is.
enum class Compose { relight, occlude, add };

/// A row in the table of composites, in the order of Compose.
struct ComposeRow {
  std::string_view name;
  Compose compose;
  std::string_view meaning;
};
inline constexpr std::array<ComposeRow, 3> kComposites = {{
    {"relight", Compose::relight, "albedo (direct + bounce)"},
    {"occlude", Compose::occlude, "the beauty with its ambient layer occluded"},
    {"add", Compose::add, "beauty + albedo (direct + bounce)"},
}};
constexpr std::string_view name_of(Compose compose) {
  return kComposites[std::size_t(compose)].name;
}

/// How the composite of a frame is made.
struct Composition {
  Compose compose = Compose::relight;
  /// For occlude: the visible part of the ambient light is ao in every channel. Otherwise it is
  /// `direct` over the direct light without occluders.
  bool share_is_ao = false;
  /// Whether outputs hold the products of each light beside those of all light.
  bool per_light = false;
  bool adds_specular = false;  ///< to relight and add: the light that surfaces mirror
  bool keeps_beauty = false;   ///< where GBuffer::masks say so

  /// Whether rendered layers are in the composite.
  bool shows_rendered() const { return compose != Compose::relight || keeps_beauty; }
};

}  // namespace ssdo
