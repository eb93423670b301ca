// SPDX-License-Identifier: Apache-2.0
#include "io/pictures/picture_layers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <map>
#include <string_view>
#include <system_error>

#include "error.h"
#include "io/exr/file/exr_file.h"
#include "io/size_guard.h"
#include "nearest_name.h"

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
    std::map<std::string, std::size_t> places;
    for (const ExrChannel& channel : part.channels) {
      if (channel.x_sampling != 1 || channel.y_sampling != 1) continue;
      const auto dot = channel.name.rfind('.');
      const std::string name = dot == std::string::npos ? "" : channel.name.substr(0, dot);
      const auto [place, is_new] = places.emplace(name, layers.size());
      if (is_new) layers.push_back({part.index, name, part.name, {}, {}});
      layers[place->second].channels.push_back(channel.name);
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
  std::error_code ignored;  // of a name that is too long for a file
  if (colon == std::string::npos || std::filesystem::exists(text, ignored)) return {text, ""};
  return {text.substr(0, colon), text.substr(colon + 1)};
}

bool reads_as_exr(const std::string& file) { return has_exr_ending(file) || begins_as_exr(file); }

std::optional<TransferCurve> curve_of(const Image& image) {
  return curve_of(image.color_space.empty() && image.integers ? "sRGB" : image.color_space);
}

std::string shown_name(const PictureLayer& layer) {
  if (!layer.name.empty()) return layer.name;
  return layer.part_name.empty() ? fmt::format("{}", fmt::join(layer.components, ","))
                                 : layer.part_name;
}

LayeredPicture::LayeredPicture(const std::string& file) : file_(file) {
  if (reads_as_exr(file)) {
    exr_.emplace(file);
    layers_ = layers_of(*exr_);
    if (layers_.empty()) {
      throw Error(ExitCode::input,
                  fmt::format("{}: holds no flat image with a value in every pixel, but deep or "
                              "subsampled ones; flatten or resample it first",
                              file));
    }
    return;
  }
  image_ = read_image(file);
  layers_ = {{0, "", "", {"R", "G", "B"}, {"R", "G", "B"}}};
  if (image_.alpha.empty()) return;
  layers_[0].channels.push_back("A");
  layers_[0].components.push_back("A");
}

std::string LayeredPicture::names() const {
  std::vector<std::string> names;
  for (const PictureLayer& layer : layers_) names.push_back(shown_name(layer));
  return some_of(names);
}

PictureLayer LayeredPicture::find(const std::string& name) const {
  using Matches = std::function<bool(const std::string& part, const std::string& own)>;
  const auto layers_with = [&](const Matches& matches) {
    std::vector<PictureLayer> found;
    for (const PictureLayer& layer : layers_) {
      if (matches(layer.part_name, layer.name)) found.push_back(layer);
    }
    return found;
  };
  const auto channels_with = [&](const Matches& matches) {
    std::vector<PictureLayer> found;
    for (const PictureLayer& layer : layers_) {
      for (const std::string& channel : layer.channels) {
        if (matches(layer.part_name, channel))
          found.push_back({layer.part, name, layer.part_name, {channel}, {""}});
      }
    }
    return found;
  };
  const Matches in_full = [&](const std::string& part, const std::string& own) {
    return name == own || (!part.empty() && name == part + "." + own);
  };
  const Matches by_last_words = [&](const std::string&, const std::string& own) {
    return ends_with_words(own, name);
  };
  auto found = layers_with(in_full);
  for (const PictureLayer& layer : layers_) {
    if (layer.name.empty() && name == shown_name(layer)) found.push_back(layer);
  }
  if (found.empty()) found = channels_with(in_full);
  if (found.empty()) found = layers_with(by_last_words);
  if (found.empty()) found = channels_with(by_last_words);
  if (found.size() == 1) return found[0];
  std::vector<std::string> shown;
  for (const PictureLayer& layer : layers_) shown.push_back(shown_name(layer));
  throw Error(ExitCode::layer, found.empty()
                                   ? fmt::format("{}: has no layer '{}'; {}there is {}", file_,
                                                 name, did_you_mean(name, shown), names())
                                   : fmt::format("{}: {} layers are called '{}'; name one of {}",
                                                 file_, found.size(), name, names()));
}

Window LayeredPicture::window(const PictureLayer& layer) const {
  if (exr_) return exr_->parts()[std::size_t(layer.part)].data_window;
  return {0, 0, image_.color.width, image_.color.height};
}

Window LayeredPicture::display(const PictureLayer& layer) const {
  return exr_ ? exr_->parts()[std::size_t(layer.part)].display_window : window(layer);
}

std::optional<TransferCurve> LayeredPicture::curve(const PictureLayer& layer) const {
  if (exr_) return curve_of(exr_->parts()[std::size_t(layer.part)].header);
  return curve_of(image_);
}

std::vector<Plane<float>> LayeredPicture::read(const PictureLayer& layer,
                                               const PixelGrid& grid) const {
  const Window rows = grid.rows_of(window(layer));
  if (exr_) {
    const double bytes = double(rows.area()) * sizeof(float);
    check_picture_size(file_, 0, bytes * double(layer.channels.size()));
    return exr_->read(layer.part, layer.channels, grid);
  }
  std::vector<Plane<float>> planes;
  for (const std::string& channel : layer.channels) {
    const auto c = glm::length_t(std::string_view("RGB").find(channel));
    Plane<float>& plane = planes.emplace_back(rows.width(), rows.height());
    for (std::size_t i = 0, from = image_.color.index(0, rows.y0); i < plane.size(); ++i)
      plane[i] = channel == "A" ? image_.alpha[from + i] : image_.color[from + i][c];
  }
  return planes;
}

}  // namespace ssdo
