// SPDX-License-Identifier: Apache-2.0
#include "io/picture_layers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>

#include "error.h"
#include "io/image_file.h"

namespace ssdo {
namespace {

/// Colours and coordinates come in their own order, all else as the file sorts it.
constexpr std::string_view kOrder = "RrXxGgYyBbZzAa";

std::size_t rank(const std::string& component) {
  return component.size() == 1 ? std::min(kOrder.find(component), kOrder.size()) : kOrder.size();
}

std::vector<PictureLayer> layers_of(const ExrReader& exr) {
  std::vector<PictureLayer> layers;
  for (const ExrPart& part : exr.parts()) {
    if (part.deep) continue;
    const std::size_t first = layers.size();
    for (const ExrChannel& channel : part.channels) {
      if (channel.x_sampling != 1 || channel.y_sampling != 1) continue;
      const auto dot = channel.name.rfind('.');
      const std::string name = dot == std::string::npos ? "" : channel.name.substr(0, dot);
      auto layer = std::find_if(layers.begin() + std::ptrdiff_t(first), layers.end(),
                                [&](const PictureLayer& l) { return l.name == name; });
      if (layer == layers.end())
        layer = layers.insert(layers.end(), {part.index, name, part.name, {}, {}});
      layer->channels.push_back(channel.name);
    }
  }
  for (PictureLayer& layer : layers) {
    const std::size_t prefix = layer.name.empty() ? 0 : layer.name.size() + 1;
    std::stable_sort(layer.channels.begin(), layer.channels.end(),
                     [&](const std::string& a, const std::string& b) {
                       return rank(a.substr(prefix)) < rank(b.substr(prefix));
                     });
    for (const std::string& channel : layer.channels)
      layer.components.push_back(channel.substr(prefix));
  }
  return layers;
}

bool ends_with_words(const std::string& text, const std::string& words) {
  return text == words || text.ends_with("." + words);
}

}  // namespace

PictureName parse_picture_name(const std::string& text) {
  const auto colon = text.rfind(':');
  if (colon == std::string::npos || std::filesystem::exists(text)) return {text, ""};
  return {text.substr(0, colon), text.substr(colon + 1)};
}

std::string shown_name(const PictureLayer& layer) {
  if (!layer.name.empty()) return layer.name;
  return layer.part_name.empty() ? fmt::format("{}", fmt::join(layer.components, ","))
                                 : layer.part_name;
}

LayeredPicture::LayeredPicture(const std::string& file) : file_(file) {
  if (!is_display_image(file)) {
    exr_.emplace(file);
    layers_ = layers_of(*exr_);
    return;
  }
  const Plane<glm::vec3> pixels = read_image(file);
  layers_ = {{0, "", "", {"R", "G", "B"}, {"R", "G", "B"}}};
  image_.assign(3, Plane<float>(pixels.width, pixels.height));
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) image_[std::size_t(c)][i] = pixels[i][c];
  }
}

std::string LayeredPicture::names() const {
  std::vector<std::string> names;
  for (const PictureLayer& layer : layers_) names.push_back(shown_name(layer));
  return names.empty() ? "nothing that can be compared" : fmt::format("{}", fmt::join(names, ", "));
}

PictureLayer LayeredPicture::find(const std::string& name) const {
  const auto all_with = [&](const auto& matches) {
    std::vector<PictureLayer> found;
    for (const PictureLayer& layer : layers_) {
      if (matches(layer)) found.push_back(layer);
    }
    return found;
  };
  auto found = all_with([&](const PictureLayer& l) {
    return name == shown_name(l) || (!l.part_name.empty() && name == l.part_name + "." + l.name);
  });
  if (found.empty())
    found = all_with([&](const PictureLayer& l) { return ends_with_words(l.name, name); });
  if (found.empty()) {
    for (const PictureLayer& layer : layers_) {
      for (std::size_t c = 0; c < layer.channels.size(); ++c) {
        if (!ends_with_words(layer.channels[c], name)) continue;
        found.push_back({layer.part, name, layer.part_name, {layer.channels[c]}, {""}});
      }
    }
  }
  if (found.size() == 1) return found[0];
  throw Error(ExitCode::layer,
              found.empty()
                  ? fmt::format("{}: has no layer '{}'; there is {}", file_, name, names())
                  : fmt::format("{}: {} layers are called '{}'; name one of {}", file_,
                                found.size(), name, names()));
}

Window LayeredPicture::window(const PictureLayer& layer) const {
  if (exr_) return exr_->parts()[std::size_t(layer.part)].data_window;
  return {0, 0, image_[0].width, image_[0].height};
}

std::vector<Plane<float>> LayeredPicture::read(const PictureLayer& layer) const {
  if (exr_) return exr_->read(layer.part, layer.channels);
  std::vector<Plane<float>> planes;
  for (const std::string& channel : layer.channels)
    planes.push_back(image_[channel == "R" ? 0 : channel == "G" ? 1 : 2]);
  return planes;
}

}  // namespace ssdo
