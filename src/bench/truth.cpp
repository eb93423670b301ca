// SPDX-License-Identifier: Apache-2.0
#include "bench/truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <string_view>

#include "error.h"
#include "io/picture_layers.h"

namespace ssdo {
namespace {

/// The last word of a layer's name in lower case, without what layer names do not care about.
std::string plain_word(const std::string& name) {
  std::string word;
  for (const char c : name.substr(name.rfind('.') + 1)) {
    if (std::isalnum(static_cast<unsigned char>(c)))
      word += char(std::tolower(static_cast<unsigned char>(c)));
  }
  return word;
}

/// The product that renderers, and this tool, give a layer of that name; empty if none.
std::string product_of(const PictureLayer& layer) {
  struct Known {
    std::string_view word, product;
  };
  static constexpr Known kNames[] = {
      {"ao", "ao"},         {"ambientocclusion", "ao"}, {"occlusion", "ao"},
      {"direct", "direct"}, {"diffdir", "direct"},      {"diffusedirect", "direct"},
      {"bounce", "bounce"}, {"diffind", "bounce"},      {"diffuseindirect", "bounce"}};
  for (const Known& known : kNames) {
    if (plain_word(layer.name) == known.word) return std::string(known.product);
  }
  return "";
}

}  // namespace

TruthRequest parse_truth(const std::string& text) {
  for (const std::string& product : kBenchProducts) {
    if (text.starts_with(product + "=")) return {product, text.substr(product.size() + 1)};
  }
  return {"", text};
}

Truth read_truth(const TruthRequest& request) {
  const PictureName name = parse_picture_name(request.picture);
  const LayeredPicture picture(name.file);
  if (name.layer.empty() && picture.layers().size() != 1) {
    throw Error(ExitCode::layer, fmt::format("--truth {}: has {} layers; name one: {}:LAYER",
                                             name.file, picture.layers().size(), name.file));
  }
  const PictureLayer layer = name.layer.empty() ? picture.layers()[0] : picture.find(name.layer);
  Truth truth;
  truth.product = request.product.empty() ? product_of(layer) : request.product;
  truth.file = name.file;
  truth.layer = shown_name(layer);
  if (truth.product.empty()) {
    throw Error(ExitCode::usage,
                fmt::format("--truth {}: the name '{}' does not tell what it is the truth of; "
                            "write ao={}, direct={} or bounce={}",
                            request.picture, shown_name(layer), request.picture, request.picture,
                            request.picture));
  }
  truth.channels = {picture.window(layer), picture.read(layer)};
  truth.display = picture.exr() ? picture.exr()->parts()[std::size_t(layer.part)].display_window
                                : truth.channels.window;
  auto& planes = truth.channels.planes;
  if (planes.size() == 4) planes.pop_back();  // alpha
  if (planes.size() != 3 && planes.size() != 1) {
    throw Error(ExitCode::layer, fmt::format("--truth {}: the layer has {} channels; 1 or 3 are "
                                             "what it can have",
                                             request.picture, planes.size()));
  }
  return truth;
}

}  // namespace ssdo
