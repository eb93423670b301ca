// SPDX-License-Identifier: Apache-2.0
#include "scene/layers/groups.h"

#include <algorithm>

#include "io/exr/kept_channels.h"
#include "scene/layers/names.h"

namespace ssdo {
namespace {

using Words = std::vector<std::string>;

constexpr std::string_view kMainView = "main";

void add_new(Words& words, const std::string& word) {
  if (std::find(words.begin(), words.end(), word) == words.end()) words.push_back(word);
}

/// The words that name a view in this file, in lower case.
Words view_words(const ExrReader& file) {
  Words words = {"left", "right", std::string(kMainView)};
  for (const ExrPart& part : file.parts()) {
    if (!part.view.empty()) add_new(words, lower(part.view));
    for (const std::string& view : views_of(part.header)) add_new(words, lower(view));
  }
  return words;
}

struct ViewedName {
  std::string view, rest;
  bool in_front = false;  ///< of the rest
};

/// Takes the view off the end or the start of a name whose words are separated by one of
/// `separators`. Without a view, `rest` is the whole name.
ViewedName split_view(const std::string& name, std::string_view separators, const Words& views) {
  const auto is_view = [&](const std::string& word) {
    return std::find(views.begin(), views.end(), lower(word)) != views.end();
  };
  if (is_view(name)) return {name, "", true};
  const auto last = name.find_last_of(separators), first = name.find_first_of(separators);
  if (last == std::string::npos) return {"", name};
  if (is_view(name.substr(last + 1))) return {name.substr(last + 1), name.substr(0, last)};
  if (is_view(name.substr(0, first))) return {name.substr(0, first), name.substr(first + 1), true};
  return {"", name};
}

/// "part.layer", unless the layer begins with the part's name as Blender and Nuke write it.
std::string qualified(const std::string& part, const std::string& layer) {
  if (part.empty() || layer == part || layer.starts_with(part + ".")) return layer;
  return layer.empty() ? part : part + "." + layer;
}

std::string default_view(const ExrPart& part) {
  const std::vector<std::string> views = views_of(part.header);
  return views.empty() ? "" : views.front();
}

LayerGroup make_group(const ExrPart& part, const std::string& layer, const Words& views) {
  const ViewedName of_part = split_view(part.name, "._- ", views),
                   of_layer = split_view(layer, ".", views);
  LayerGroup group;
  group.part = part.index;
  group.layer = layer;
  group.name = qualified(part.name, layer);
  group.own_path = of_layer.rest;
  group.path = qualified(of_part.rest, of_layer.rest);
  for (const std::string& view : {part.view, of_part.view, of_layer.view, default_view(part)}) {
    if (group.view.empty()) group.view = view;
  }
  return group;
}

}  // namespace

std::pair<std::string, std::string> split_channel(const std::string& channel) {
  const auto dot = channel.rfind('.');
  if (dot == std::string::npos) return {"", channel};
  return {channel.substr(0, dot), channel.substr(dot + 1)};
}

std::vector<LayerGroup> group_channels(const ExrReader& file, int file_index) {
  const Words views = view_words(file);
  std::vector<LayerGroup> groups;
  for (const ExrPart& part : file.parts()) {
    if (part.deep) continue;
    const EarlierProducts earlier = earlier_products(part);
    std::map<std::pair<std::string, bool>, LayerGroup> by_layer;
    const auto add = [&](const std::string& name, const ExrChannel& channel, bool by_earlier_run) {
      const auto [layer, component] = split_channel(name);
      const auto [group, is_new] = by_layer.try_emplace({layer, by_earlier_run});
      if (is_new) group->second = make_group(part, layer, views);
      group->second.by_earlier_run = by_earlier_run;
      group->second.components[lower(component)] = channel;
    };
    for (const ExrChannel& channel : part.channels) {
      if (channel.x_sampling != 1 || channel.y_sampling != 1) continue;
      add(channel.name, channel, earlier.contains(channel.name));
      for (const auto& [name, moved] : earlier)
        if (moved == channel.name) add(name, channel, false);
    }
    for (auto& [layer, group] : by_layer) {
      group.file = file_index;
      group.only_part = file.parts().size() == 1;
      groups.push_back(std::move(group));
    }
  }
  return groups;
}

std::vector<LayerGroup> group_channels(const ExrReader& file, int file_index,
                                       const std::string& view) {
  std::vector<LayerGroup> groups = group_channels(file, file_index);
  if (view.empty() || views_of(groups).empty()) return groups;
  std::erase_if(groups, [&](const LayerGroup& group) {
    return lower(group.view) != view && !same_view(group.view, "");
  });
  return groups;
}

std::string in_view_of(const ExrReader& file, const ExrPart& part, const std::string& beside,
                       const std::string& channel) {
  if (views_of(group_channels(file, 0)).empty()) return channel;
  const ViewedName like = split_view(split_channel(beside).first, ".", view_words(file));
  const auto [layer, component] = split_channel(channel);
  const bool is_default = same_view(like.view, default_view(part));
  if (like.view.empty() || (layer.empty() && is_default)) return channel;
  if (layer.empty()) return like.view + "." + component;
  return like.in_front ? like.view + "." + channel : layer + "." + like.view + "." + component;
}

bool same_view(const std::string& a, const std::string& b) {
  const auto own = [](const std::string& view) {
    const std::string name = lower(view);
    return name == kMainView ? "" : name;
  };
  return own(a) == own(b);
}

std::vector<std::string> views_of(const std::vector<LayerGroup>& groups) {
  Words views;
  std::size_t named = 0;
  for (const LayerGroup& group : groups) {
    const bool known = std::any_of(views.begin(), views.end(), [&](const std::string& view) {
      return same_view(view, group.view);
    });
    if (known) continue;
    views.push_back(group.view);
    named += !same_view(group.view, "");
  }
  return named < 2 ? Words{} : views;
}

}  // namespace ssdo
