// SPDX-License-Identifier: Apache-2.0
#include "scene/layers/names.h"

#include <fnmatch.h>

#include <cctype>

namespace ssdo {

std::string lower(std::string_view text) {
  std::string out;
  for (char c : text) out += char(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::string normalise(std::string_view text) {
  std::string out;
  for (char c : lower(text)) {
    if (c != ' ' && c != '_' && c != '-') out += c;
  }
  return out;
}

std::optional<std::size_t> rank_of(Role role, const std::vector<std::string>& keys) {
  const std::vector<std::string>& names = row_of(role).layers;
  for (std::size_t rank = 0; rank < names.size(); ++rank) {
    for (const std::string& key : keys) {
      if (fnmatch(names[rank].c_str(), key.c_str(), 0) == 0) return rank;
    }
  }
  return std::nullopt;
}

}  // namespace ssdo
