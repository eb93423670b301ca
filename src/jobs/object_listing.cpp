// SPDX-License-Identifier: Apache-2.0
#include "jobs/object_listing.h"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "io/one_line.h"

namespace ssdo {
namespace {

/// Names of a layer that a line holds; JSON holds all.
constexpr int kMostNames = 20;

}  // namespace

ObjectListing list_objects(const Frame& frame) {
  ObjectListing out;
  for (const ExrReader& file : frame.files) {
    std::vector<ObjectShare> own = objects_of(file, frame.view, out.warnings);
    std::move(own.begin(), own.end(), std::back_inserter(out.objects));
  }
  return out;
}

std::string text_of(const ObjectListing& listing) {
  const std::vector<ObjectShare>& all = listing.objects;
  std::string text;
  for (std::size_t i = 0; i < all.size();) {
    const std::string& layer = all[i].layer;
    std::string line;
    int names = 0;
    for (; i < all.size() && all[i].layer == layer; ++i, ++names) {
      if (names < kMostNames)
        line +=
            fmt::format("{}{} {:.2g} %", names > 0 ? ", " : "", all[i].name, 100 * all[i].share);
    }
    if (names > kMostNames) line += fmt::format(" and {} more", names - kMostNames);
    text += fmt::format("  {:<10}{}: {}\n", "objects", printable(layer), printable(line));
  }
  for (const std::string& warning : listing.warnings)
    text += fmt::format("  {:<10}{}\n", "warning", printable(warning));
  return text;
}

nlohmann::json to_json(const ObjectListing& listing) {
  nlohmann::json out = nlohmann::json::object();
  for (const auto& [layer, name, share] : listing.objects) out[layer][name] = share;
  return out;
}

}  // namespace ssdo
