// SPDX-License-Identifier: Apache-2.0
#include "metrics/picture_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "error.h"
#include "scene/layers/names.h"

namespace ssdo {
namespace {

/// The layer with only those components that `other` has too.
PictureLayer common_components(const PictureLayer& layer, const PictureLayer& other) {
  PictureLayer common = layer;
  common.channels.clear(), common.components.clear();
  for (std::size_t c = 0; c < layer.channels.size(); ++c) {
    const auto& others = other.components;
    if (std::find(others.begin(), others.end(), layer.components[c]) == others.end()) continue;
    common.channels.push_back(layer.channels[c]);
    common.components.push_back(layer.components[c]);
  }
  return common;
}

/// The layer among `layers` that `wanted` is compared with, or none. Layers of the same name in
/// several parts belong to the parts of the same name.
const PictureLayer* counterpart(const PictureLayer& wanted,
                                const std::vector<PictureLayer>& layers) {
  const PictureLayer* best = nullptr;
  int best_rank = 0;
  for (const PictureLayer& layer : layers) {
    if (layer.name != wanted.name || common_components(layer, wanted).channels.empty()) continue;
    const int rank =
        1 + (layer.part_name == wanted.part_name) + 2 * (layer.components == wanted.components);
    if (rank <= best_rank) continue;
    best = &layer;
    best_rank = rank;
  }
  return best;
}

/// The channels that are measured together: colours, or a coordinate; an alpha, a depth and all
/// else alone. `layer` has one of them.
std::vector<std::size_t> channels_beside(const PictureLayer& layer, std::size_t channel) {
  const auto kind = [&](std::size_t c) {
    const std::string name = lower(layer.components[c]);
    for (const char* color : {"r", "g", "b", "red", "green", "blue"})
      if (name == color) return std::string("color");
    return name == "x" || name == "y" || name == "z" ? std::string("coordinate") : "alone " + name;
  };
  const auto has = [&](std::string_view component) {
    return std::ranges::any_of(layer.components,
                               [&](const std::string& own) { return lower(own) == component; });
  };
  const bool alone = kind(channel) == "coordinate" && !(has("x") && has("y"));
  std::vector<std::size_t> beside;
  for (std::size_t c = 0; c < layer.channels.size(); ++c)
    if (c == channel || (!alone && kind(c) == kind(channel))) beside.push_back(c);
  return beside;
}

/// Some channels of a layer; called after the channel where it is one of several.
PictureLayer piece_of(const PictureLayer& layer, const std::vector<std::size_t>& channels) {
  PictureLayer piece = layer;
  piece.channels.clear(), piece.components.clear();
  for (const std::size_t c : channels) {
    piece.channels.push_back(layer.channels[c]);
    piece.components.push_back(layer.components[c]);
  }
  if (channels.size() == 1 && layer.channels.size() > 1) {
    const std::string& of = layer.name.empty() ? layer.part_name : layer.name;
    piece.name = (of.empty() ? "" : of + ".") + piece.components[0];
  }
  return piece;
}

/// A pair by what its channels are.
std::vector<LayerPair> pieces_of(const LayerPair& pair) {
  if (pair.a.components != pair.b.components) return {pair};
  std::vector<LayerPair> pieces;
  for (std::size_t c = 0; c < pair.a.channels.size(); ++c) {
    const std::vector<std::size_t> beside = channels_beside(pair.a, c);
    if (beside[0] == c) pieces.push_back({piece_of(pair.a, beside), piece_of(pair.b, beside)});
  }
  return pieces;
}

}  // namespace

std::string LayerPair::name() const {
  const std::string of_a = shown_name(a), of_b = shown_name(b);
  return of_a == of_b ? of_a : fmt::format("{} - {}", of_a, of_b);
}

std::vector<LayerPair> pair_layers(const LayeredPicture& a, const LayeredPicture& b,
                                   const std::string& layer_a, const std::string& layer_b) {
  if (!layer_a.empty() || !layer_b.empty())
    return {
        {a.find(layer_a.empty() ? layer_b : layer_a), b.find(layer_b.empty() ? layer_a : layer_b)}};
  std::vector<LayerPair> pairs;
  for (const PictureLayer& layer : a.layers()) {
    if (const PictureLayer* match = counterpart(layer, b.layers()))
      pairs.push_back({common_components(layer, *match), common_components(*match, layer)});
  }
  if (!pairs.empty()) return pairs;
  throw Error(ExitCode::layer,
              fmt::format("{} and {} have no layer in common; pair two by name: {}:LAYER {}:LAYER",
                          a.file(), b.file(), a.file(), b.file()));
}

std::vector<LayerPair> layers_alone(const LayeredPicture& picture, const std::string& layer) {
  if (!layer.empty()) return {{picture.find(layer), picture.find(layer)}};
  std::vector<LayerPair> pairs;
  for (const PictureLayer& one : picture.layers()) pairs.push_back({one, one});
  return pairs;
}

std::vector<LayerPair> split_by_kind(const std::vector<LayerPair>& pairs) {
  std::vector<LayerPair> all;
  for (const LayerPair& pair : pairs)
    for (LayerPair& piece : pieces_of(pair)) all.push_back(std::move(piece));
  return all;
}

std::vector<std::string> unpaired(const LayeredPicture& picture,
                                  const std::vector<LayerPair>& pairs,
                                  PictureLayer LayerPair::*side) {
  std::set<std::pair<int, std::string>> paired;
  for (const LayerPair& pair : pairs)
    for (const std::string& channel : (pair.*side).channels)
      paired.insert({(pair.*side).part, channel});
  std::vector<std::string> names;
  for (const PictureLayer& layer : picture.layers()) {
    for (const std::string& channel : layer.channels) {
      if (!paired.contains({layer.part, channel}))
        names.push_back(layer.part_name.empty() ? channel : layer.part_name + "." + channel);
    }
  }
  return names;
}

bool lacks_counterpart(const LayeredPicture& picture, const std::vector<LayerPair>& pairs,
                       PictureLayer LayerPair::*side) {
  for (const std::string& channel : unpaired(picture, pairs, side)) {
    const std::string component = lower(channel.substr(channel.rfind('.') + 1));
    if (component != "a" && component != "alpha") return true;
  }
  return false;
}

}  // namespace ssdo
