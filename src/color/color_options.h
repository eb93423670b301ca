// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "io/pictures/primaries.h"

namespace ssdo {

/// What the user says about colour. Empty means: decide.
struct ColorOptions {
  std::string ocio{};        ///< config file; over $OCIO over the built-in config
  std::string colorspace{};  ///< of the input's colours
  std::string display{}, view{}, look{};
};

/// What a file says about its own colours.
struct ColorTags {
  std::filesystem::path path{};  ///< for the config's file rules
  std::string interop_id{};      ///< attribute `colorInteropID`
  bool aces_container = false;   ///< attribute `acesImageContainerFlag` = 1
  std::optional<Chromaticities> chromaticities{};
};

}  // namespace ssdo
