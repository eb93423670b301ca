// SPDX-License-Identifier: Apache-2.0
#include "bench/truth.h"

#include <fmt/format.h>

#include <cctype>
#include <sstream>

#include "error.h"
#include "io/pictures/picture_layers.h"

namespace ssdo {
namespace {

/// The last word of a layer's name in lower case, letters and digits only.
std::string plain_word(const std::string& name) {
  std::string word;
  for (const char c : name.substr(name.rfind('.') + 1)) {
    if (std::isalnum(static_cast<unsigned char>(c)))
      word += char(std::tolower(static_cast<unsigned char>(c)));
  }
  return word;
}

/// The product that a layer of that name holds in files of renderers and of this tool; empty if
/// none.
std::string product_of(const PictureLayer& layer) {
  const std::string word = plain_word(layer.name);
  for (const Product& product : kProducts) {
    std::istringstream names(std::string(product.name) + ' ' + std::string(product.aka));
    for (std::string name; product.measured && names >> name;) {
      if (name == word) return std::string(product.name);
    }
  }
  return "";
}

/// "ao=TEXT, direct=TEXT, ...".
std::string with_each_product(const std::string& text) {
  std::string all;
  for (const std::string& product : measured_products())
    all += fmt::format("{}{}={}", all.empty() ? "" : ", ", product, text);
  return all;
}

}  // namespace

std::vector<std::string> measured_products() {
  std::vector<std::string> names;
  for (const Product& product : kProducts) {
    if (product.measured) names.emplace_back(product.name);
  }
  return names;
}

TruthRequest parse_truth(const std::string& text) {
  for (const std::string& product : measured_products()) {
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
    throw Error(
        ExitCode::usage,
        fmt::format("--truth {}: the name '{}' does not tell what it is the truth of; "
                    "write one of {}",
                    request.picture, shown_name(layer), with_each_product(request.picture)));
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
