// SPDX-License-Identifier: Apache-2.0
#include "jobs/listing.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "error.h"
#include "io/exr/file/exr_parts.h"
#include "io/one_line.h"
#include "scene/layers/groups.h"

namespace ssdo {
namespace {

using nlohmann::json;
using Channels = std::vector<ExrChannel>;

std::string_view type_name(Imf::PixelType type) {
  return type == Imf::HALF ? "half" : type == Imf::FLOAT ? "float" : "uint";
}

std::string component_of(const ExrChannel& channel) { return split_channel(channel.name).second; }

/// Channels in the order R, G, B, while a header sorts them by name.
std::size_t place_of(const ExrChannel& channel) {
  constexpr std::string_view kOrder = "rgbaxyz";
  const std::string component = component_of(channel);
  const auto first =
      component.empty() ? '?' : std::tolower(static_cast<unsigned char>(component[0]));
  return std::min(kOrder.find(char(first)), kOrder.size());
}

std::string kind_of(const ExrChannel& c) {
  const std::string type(type_name(c.type));
  if (c.x_sampling == 1 && c.y_sampling == 1) return type;
  return fmt::format("{} subsampled {} x {}", type, c.x_sampling, c.y_sampling);
}

/// "R G B half, A float".
std::string list_components(Channels channels) {
  std::stable_sort(channels.begin(), channels.end(), [](const ExrChannel& a, const ExrChannel& b) {
    return place_of(a) < place_of(b);
  });
  std::string text;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const std::string kind = kind_of(channels[i]);
    text += component_of(channels[i]) + " ";
    const bool last = i + 1 == channels.size();
    if (last || kind_of(channels[i + 1]) != kind) text += kind + (last ? "" : ", ");
  }
  return text;
}

std::string list_part(const ExrPart& part) {
  std::string text = "  " + label(part);
  if (!part.view.empty()) text += fmt::format(", view '{}'", part.view);
  text += fmt::format(": {}{}, display window {}", part.deep ? "deep " : "",
                      is_tiled(part) ? "tiles" : "scanlines", text_of(part.display_window));
  if (!(part.data_window == part.display_window))
    text += ", data window " + text_of(part.data_window);
  if (part.header.pixelAspectRatio() != 1)
    text += fmt::format(", pixel aspect {:.4g}", part.header.pixelAspectRatio());
  text = printable(text) + "\n";

  std::vector<std::pair<std::string, Channels>> layers;
  for (const ExrChannel& channel : part.channels) {
    const std::string layer = split_channel(channel.name).first;
    const auto same = std::find_if(layers.begin(), layers.end(),
                                   [&](const auto& other) { return other.first == layer; });
    if (same == layers.end())
      layers.push_back({layer, {channel}});
    else
      same->second.push_back(channel);
  }
  for (const auto& [layer, channels] : layers) {
    const std::string name = layer.empty() ? "(no layer)" : printable(layer);
    text += fmt::format("    {:<30} {}\n", name, printable(list_components(channels)));
  }
  return text;
}

std::string list_file(const ExrReader& file) {
  std::size_t channels = 0;
  for (const ExrPart& part : file.parts()) channels += part.channels.size();
  std::string text =
      fmt::format("{}: {} part{}, {} channels\n", printable(file.path().string()),
                  file.parts().size(), file.parts().size() == 1 ? "" : "s", channels);
  for (const ExrPart& part : file.parts()) text += list_part(part);
  return text;
}

}  // namespace

json parts_json(const ExrReader& file) {
  json parts = json::array();
  for (const ExrPart& part : file.parts()) {
    json channels = json::array();
    for (const ExrChannel& c : part.channels)
      channels.push_back({{"name", c.name}, {"type", type_name(c.type)}});
    parts.push_back({{"name", part.name},
                     {"view", part.view},
                     {"deep", part.deep},
                     {"tiled", is_tiled(part)},
                     {"data_window", window_json(part.data_window)},
                     {"display_window", window_json(part.display_window)},
                     {"pixel_aspect", part.header.pixelAspectRatio()},
                     {"channels", channels}});
  }
  return parts;
}

json window_json(const Window& w) { return {w.x0, w.y0, w.x1 - 1, w.y1 - 1}; }

std::deque<ExrReader> open_files(const FrameFiles& files) {
  std::vector<std::string> paths = files_of_frame(files.input, files.aovs);
  paths.insert(paths.end(), files.also.begin(), files.also.end());
  std::deque<ExrReader> opened;
  for (const std::string& path : paths) {
    try {
      opened.emplace_back(path);
    } catch (const Error&) {
      // The run that follows opens the file again and reports the error.
    }
  }
  return opened;
}

std::string list_layers(const std::deque<ExrReader>& files) {
  std::string text;
  for (const ExrReader& file : files) text += list_file(file);
  return text;
}

json listing_json(const std::string& input, const std::deque<ExrReader>& files) {
  json listing = {{"file", input}, {"parts", json::array()}};
  for (const ExrReader& file : files) {
    if (file.path() == input)
      listing["parts"] = parts_json(file);
    else
      listing["other_files"].push_back(
          {{"file", file.path().string()}, {"parts", parts_json(file)}});
  }
  return listing;
}

}  // namespace ssdo
