// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/layers/layers.h"
#include "support/exr_fixture.h"
#include "support/temp_dir.h"

namespace ssdo::test {

using Channels = std::vector<std::string>;

/// A part of a file that is there for the names of its layers.
struct LayerPart {
  std::string name;
  Channels channels;
  std::string view = {};     ///< the attribute `view`; empty: none
  Channels multi_view = {};  ///< the attribute `multiView`; empty: none
};

/// An EXR of 2 x 2 pixels: one part, or several with names.
class LayerFile {
 public:
  explicit LayerFile(const Channels& names) : LayerFile(std::vector<LayerPart>{{"", names}}) {}
  explicit LayerFile(const std::vector<LayerPart>& parts);

  /// The layers that --aov and --part find.
  LayerTable find(const std::vector<std::string>& aov = {}, const std::string& part = "") const;
  std::filesystem::path path() const { return dir_ / "frame.exr"; }

 private:
  TempDir dir_;
};

Channels channels_of(const LayerTable& table, Role role);

std::string name_of(const LayerTable& table, Role role);

int part_of(const LayerTable& table, Role role);

}  // namespace ssdo::test
