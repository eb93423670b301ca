// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/exr/exr_reader.h"

namespace ssdo {

/// The two views of a stereo file.
inline constexpr std::array<std::string_view, 2> kEyes = {"left", "right"};

/// A channel's name at its last dot: layer and component. No dot: no layer.
std::pair<std::string, std::string> split_channel(const std::string& channel);

/// The channels of a flat part that share a layer.
struct LayerGroup {
  int file = 0, part = 0;
  std::string name;             ///< part and layer as the file spells them, for messages and --aov
  std::string layer;            ///< in the names of the channels
  std::string view;             ///< "left", or empty
  std::string path;             ///< name without the view
  std::string own_path;         ///< layer without the view
  bool only_part = true;        ///< of its file
  bool by_earlier_run = false;  ///< of ssdo, a product: no part of the render
  std::map<std::string, ExrChannel> components;  ///< by component in lower case

  const ExrChannel* find(std::string_view component) const {
    const auto it = components.find(std::string(component));
    return it == components.end() ? nullptr : &it->second;
  }
};

/// The groups of a file's flat parts, without subsampled channels. The view of a group is the
/// part's attribute `view`; else a word at the start or end of the part's name ("P.left",
/// "P_main") or of the layer ("P.left.X", "left.P.X") that is left, right, main or a view of the
/// file; else, in a part with the attribute `multiView`, the first view of that.
///
/// In an output of ssdo, channels that gave way to its products form the layers that they were
/// before ("input.R" is the R of the file without a layer), and "input" as well.
std::vector<LayerGroup> group_channels(const ExrReader& file, int file_index);

/// The groups of a view, and those of no view; all groups where `view` is empty or the file does
/// not tell views apart.
std::vector<LayerGroup> group_channels(const ExrReader& file, int file_index,
                                       const std::string& view);

/// What a channel is called in the view of another: as `channel` where parts tell views apart, or
/// where the view is the default one and goes without its name; else "ao.right.Y" beside
/// "P.right.X", "right.ao.Y" beside "right.P.X", and "right.R" beside both.
/// `beside` is a channel of `part`, a part of `file`.
std::string in_view_of(const ExrReader& file, const ExrPart& part, const std::string& beside,
                       const std::string& channel);

/// Whether two views are the same. "main" is Nuke's name for the only view, as good as none.
bool same_view(const std::string& a, const std::string& b);

/// The views that `groups` tell apart; empty where there are not at least two with names.
std::vector<std::string> views_of(const std::vector<LayerGroup>& groups);

}  // namespace ssdo
