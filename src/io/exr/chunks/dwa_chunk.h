// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/exr/file/exr_parts.h"

// A chunk of DWAA or DWAB begins with eleven numbers of eight bytes, little endian: its version;
// the bytes of the deflated channels, before and after packing; the packed bytes of the AC
// coefficients, of the DC coefficients (the first of each block of 8 x 8), and of the runs; the
// bytes of the runs when unpacked, and of the channels that they hold; the numbers of AC and of DC
// coefficients; and how the AC ones are packed. From version 2 on, the size of a list of rules and
// the rules follow, which say how each channel is stored. Then come the deflated channels. (OpenEXR
// 3.1, ImfDwaCompressor.h, DataSizesSingle; ImfDwaCompressor.cpp.)

namespace ssdo {

/// How a channel is stored, numbered as in files.
enum class DwaScheme { deflated, transformed, runs };

/// Gives the scheme of channels by the last part of their name and by their type.
struct DwaRule {
  std::string suffix;
  Imf::PixelType type;
  DwaScheme scheme;
  bool ignores_case;
};

/// What a chunk says of itself.
struct DwaChunk {
  std::vector<DwaRule> rules = {};
  std::span<const std::byte> deflated = {};  ///< packed
  std::uint64_t runs = 0;                    ///< the bytes of all channels that are stored so
  std::uint64_t blocks = 0;                  ///< of all channels that are transformed
  bool has_coefficients = false;             ///< besides the first of each block
};

/// Nothing where the bytes are no such chunk.
std::optional<DwaChunk> read_dwa_chunk(std::span<const std::byte> packed);

/// The last rule that matches decides; without one, a channel is deflated.
DwaScheme scheme_of(const ExrChannel& channel, std::span<const DwaRule> rules);

}  // namespace ssdo
