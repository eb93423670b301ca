// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace ssdo {

/// What the header of a file says of one Cryptomatte.
struct CryptomatteHeader {
  std::string name;        ///< of its layers, without their number
  std::string manifest;    ///< JSON; may be empty
  std::string file;        ///< that has the manifest, beside the picture; may be empty
  std::string hash;        ///< of names
  std::string conversion;  ///< of hashes to ids
};

/// Bits of ids by name. Errors: ExitCode::input where there is a manifest that cannot be used.
std::map<std::string, std::uint32_t> read_manifest(const CryptomatteHeader& header,
                                                   const std::filesystem::path& picture);

}  // namespace ssdo
