// SPDX-License-Identifier: Apache-2.0
#include "scene/objects/cryptomatte.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <array>

#include "error.h"
#include "io/one_line.h"
#include "scene/layers/groups.h"
#include "scene/layers/names.h"
#include "scene/objects/manifest.h"
#include "scene/objects/object_hash.h"

namespace ssdo {
namespace {

/// What all attributes of a Cryptomatte have in their name; Nuke puts a prefix before it.
constexpr std::string_view kAttribute = "cryptomatte/";

/// The only hash and conversion of the specification.
constexpr std::string_view kHash = "MurmurHash3_32", kConversion = "uint32_to_float32";

/// The spellings of the channels of a layer: id and coverage of two ranks.
constexpr std::array<std::array<std::string_view, 2>, 4> kComponents = {
    {{"r", "red"}, {"g", "green"}, {"b", "blue"}, {"a", "alpha"}}};

constexpr int kMostLayers = 100;  // two digits

/// The Cryptomattes of a header by the key of their attributes.
std::map<std::string, CryptomatteHeader> headers_of(const Imf::Header& header) {
  std::map<std::string, CryptomatteHeader> found;
  for (auto it = header.begin(); it != header.end(); ++it) {
    const std::string attribute = it.name();
    const auto at = attribute.find(kAttribute), slash = attribute.rfind('/');
    if (at == attribute.npos || slash < at + kAttribute.size()) continue;
    CryptomatteHeader& one = found[attribute.substr(0, slash)];
    const std::string field = attribute.substr(slash + 1),
                      value = string_attribute(header, attribute);
    if (field == "name") one.name = value;
    if (field == "manifest") one.manifest = value;
    if (field == "manif_file") one.file = value;
    if (field == "hash") one.hash = value;
    if (field == "conversion") one.conversion = value;
  }
  return found;
}

/// The layers of the Cryptomattes of a file.
class RankFinder {
 public:
  RankFinder(const ExrReader& file, const std::string& view)
      : file_(file), groups_(group_channels(file, 0, view)) {}

  std::vector<Cryptomatte::Rank> find(const std::string& name) const {
    std::vector<Cryptomatte::Rank> ranks;
    bool ended = false;
    for (int layer = 0; layer < kMostLayers; ++layer) {
      const LayerGroup* group = layer_named(fmt::format("{}{:02}", name, layer));
      if (!group) {
        ended = true;
        continue;
      }
      if (ended) refuse(name, fmt::format("has a layer {:02}, and none before it", layer));
      add(name, *group, ranks);
    }
    if (ranks.empty()) refuse(name, "has no layer " + printable(name) + "00");
    return ranks;
  }

 private:
  [[noreturn]] void refuse(const std::string& name, const std::string& what) const {
    throw Error(ExitCode::input,
                fmt::format("{}: Cryptomatte '{}' {}; write all of its layers in 32 bits",
                            printable(file_.path().string()), printable(name), what));
  }

  const LayerGroup* layer_named(const std::string& wanted) const {
    const auto is_it = [&](const LayerGroup& group) {
      for (const std::string& name : {group.name, group.layer, group.path, group.own_path})
        if (lower(name) == lower(wanted)) return true;
      return false;
    };
    const auto group = std::ranges::find_if(groups_, is_it);
    return group == groups_.end() ? nullptr : &*group;
  }

  void add(const std::string& name, const LayerGroup& group,
           std::vector<Cryptomatte::Rank>& ranks) const {
    const auto channel = [&](std::size_t i) -> const ExrChannel* {
      for (const std::string_view spelling : kComponents[i])
        if (const ExrChannel* found = group.find(spelling)) return found;
      return nullptr;
    };
    for (std::size_t i = 0; i < kComponents.size(); i += 2) {
      const ExrChannel *id = channel(i), *coverage = channel(i + 1);
      if (!id && !coverage && i > 0) continue;
      if (!id || !coverage)
        refuse(name,
               fmt::format("lacks channel {} of {}", id ? kComponents[i + 1][0] : kComponents[i][0],
                           printable(group.name)));
      if (id->type != Imf::FLOAT)
        refuse(name, fmt::format("has its ids in channel {} of another type than float, which "
                                 "has lost them",
                                 printable(id->name)));
      ranks.push_back({group.part, id->name, coverage->name});
    }
  }

  const ExrReader& file_;
  std::vector<LayerGroup> groups_;
};

void check_header(const ExrReader& file, const CryptomatteHeader& header) {
  const auto refuse = [&](std::string_view what, const std::string& found,
                          std::string_view wanted) {
    throw Error(ExitCode::input,
                fmt::format("{}: Cryptomatte '{}' has {} '{}'; only {} is known, so give a matte",
                            printable(file.path().string()), printable(header.name), what,
                            printable(found), wanted));
  };
  if (!header.conversion.empty() && header.conversion != kConversion)
    refuse("conversion", header.conversion, kConversion);
  // A manifest gives the ids, whatever hash made them.
  const bool has_manifest = !header.manifest.empty() || !header.file.empty();
  if (!has_manifest && !header.hash.empty() && header.hash != kHash)
    refuse("hash", header.hash, kHash);
}

}  // namespace

std::set<std::uint32_t> Cryptomatte::ids_of(const std::string& pattern) const {
  if (const auto own = ids.find(pattern); own != ids.end()) return {own->second};
  if (!has_manifest) {
    if (pattern.find_first_of("*?[") != pattern.npos) return {};  // there are no names to match
    return {cryptomatte_id(pattern)};
  }
  std::set<std::uint32_t> found;
  for (const auto& [each, id] : ids)
    if (fnmatch(pattern.c_str(), each.c_str(), 0) == 0) found.insert(id);
  return found;
}

std::vector<Cryptomatte> find_cryptomattes(const ExrReader& file, const std::string& view) {
  const RankFinder ranks(file, view);
  std::map<std::string, CryptomatteHeader> by_name;  // several parts may repeat it
  for (const ExrPart& part : file.parts()) {
    for (auto& [key, header] : headers_of(part.header)) {
      if (header.name.empty()) continue;
      CryptomatteHeader& kept = by_name[header.name];
      if (kept.manifest.empty() && kept.file.empty()) kept = std::move(header);
    }
  }
  std::vector<Cryptomatte> found;
  for (const auto& [name, header] : by_name) {
    check_header(file, header);
    Cryptomatte& one = found.emplace_back();
    one.name = name;
    one.ranks = ranks.find(name);
    one.ids = read_manifest(header, file.path());
    one.has_manifest = !one.ids.empty();
  }
  return found;
}

}  // namespace ssdo
