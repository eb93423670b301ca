// SPDX-License-Identifier: Apache-2.0
#include "scene/deep/channels.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "error.h"
#include "io/exr/file/exr_parts.h"
#include "scene/layers/groups.h"
#include "scene/layers/names.h"

namespace ssdo {
namespace {

/// A channel of a deep part, its name split into layer and component in lower case.
struct Named {
  DeepChannel channel;
  std::string layer, component;
};

std::vector<Named> channels_of(const ExrPart& part) {
  std::vector<Named> all;
  for (const ExrChannel& c : part.channels) {
    const auto [layer, component] = split_channel(c.name);
    all.push_back({{part.index, c.name}, layer, lower(component)});
  }
  return all;
}

const Named* find(const std::vector<Named>& all, const std::string& layer,
                  const std::string& component) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Named& n) {
    return n.layer == layer && n.component == component;
  });
  return found == all.end() ? nullptr : &*found;
}

/// The depths of a part: every Z that is not the third of three coordinates. One without a layer
/// is that of the picture, whatever other layers there are.
std::vector<DeepChannel> depths_of(const ExrPart& part) {
  const std::vector<Named> all = channels_of(part);
  if (const Named* plain = find(all, "", "z"); plain && !find(all, "", "x"))
    return {plain->channel};
  std::vector<DeepChannel> depths;
  for (const Named& n : all) {
    if (n.component == "z" && !find(all, n.layer, "x")) depths.push_back(n.channel);
  }
  return depths;
}

/// The channel of this component that belongs to a depth: of the same layer, or else of any layer
/// of the part; "" where there is none.
DeepChannel beside(const ExrPart& part, const std::string& layer, const std::string& component) {
  const std::vector<Named> all = channels_of(part);
  if (const Named* same = find(all, layer, component)) return same->channel;
  const auto any = std::find_if(all.begin(), all.end(),
                                [&](const Named& n) { return n.component == component; });
  return any == all.end() ? DeepChannel{} : any->channel;
}

std::vector<const ExrPart*> deep_parts(const ExrReader& file, const std::string& wanted) {
  std::vector<const ExrPart*> parts;
  for (const ExrPart& part : file.parts()) {
    const bool is_wanted = wanted.empty() || part.name == wanted ||
                           std::to_string(part.index) == wanted ||
                           lower(part.view) == lower(wanted);
    if (part.deep && is_wanted) parts.push_back(&part);
  }
  return parts;
}

}  // namespace

bool has_deep_part(const ExrReader& file) { return !deep_parts(file, "").empty(); }

std::optional<DeepChannels> find_deep_channels(const ExrReader& file, const std::string& wanted) {
  const std::vector<const ExrPart*> parts = deep_parts(file, wanted);
  if (parts.empty()) return std::nullopt;
  std::vector<DeepChannel> depths;
  std::vector<std::string> names;
  for (const ExrPart* part : parts) {
    for (const DeepChannel& depth : depths_of(*part)) {
      depths.push_back(depth);
      names.push_back(fmt::format("'{}' in {}", depth.name, label(*part)));
    }
  }
  const std::string path = file.path().string();
  if (depths.empty()) {
    throw Error(
        ExitCode::layer,
        fmt::format("{}: its deep samples have no Z; write the depth of samples too", path));
  }
  if (depths.size() > 1) {
    throw Error(ExitCode::layer,
                fmt::format("{}: {} deep channels could be the depth: {}; keep one in the file, or "
                            "choose a part of INPUT with --part",
                            path, depths.size(), fmt::join(names, ", ")));
  }
  DeepChannels found{depths[0], {}, {}};
  const ExrPart& lead = file.parts()[std::size_t(depths[0].part)];
  const std::string layer = split_channel(depths[0].name).first;
  found.back = beside(lead, layer, "zback");
  found.alpha = beside(lead, layer, "a");
  for (const ExrPart& part : file.parts()) {
    if (!part.deep || part.index == lead.index || !same_view(part.view, lead.view)) continue;
    if (found.back.name.empty()) found.back = beside(part, layer, "zback");
    if (found.alpha.name.empty()) found.alpha = beside(part, layer, "a");
  }
  return found;
}

}  // namespace ssdo
