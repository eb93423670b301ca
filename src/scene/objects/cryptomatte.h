// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "io/exr/exr_reader.h"

namespace ssdo {

/// A level of a Cryptomatte, of objects, materials or assets (Friedman and Jones, Cryptomatte
/// specification 1.2.0). Each pixel has ranks: ids of what it shows, as the bits of a float, and
/// how much of the pixel each covers.
struct Cryptomatte {
  /// Channels of a rank, in one part.
  struct Rank {
    int part = 0;
    std::string id, coverage;
  };

  std::string name;                          ///< "ViewLayer.CryptoObject"
  std::map<std::string, std::uint32_t> ids;  ///< the manifest: bits of the id of each name
  bool has_manifest = false;                 ///< else ids are hashes of names
  std::vector<Rank> ranks;

  /// The ids of what `name` means here: the one of this name, or else of all that match it as a
  /// pattern with *, ? and [...].
  std::set<std::uint32_t> ids_of(const std::string& pattern) const;
};

/// The Cryptomattes of a file, by what its headers say. `view` as of group_channels(). Errors:
/// ExitCode::input for a manifest that is none, missing ranks, and ids that are not stored in 32
/// bits.
std::vector<Cryptomatte> find_cryptomattes(const ExrReader& file, const std::string& view);

}  // namespace ssdo
