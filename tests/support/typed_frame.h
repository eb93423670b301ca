// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfHeader.h>
#include <ImfPixelType.h>

#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "support/frame_file.h"

namespace ssdo::test {

/// Pixels of one channel in the type that the file stores.
struct TypedChannel {
  Imf::PixelType type = Imf::FLOAT;
  std::vector<std::byte> bytes;
};

template <class Values>
TypedChannel typed(Imf::PixelType type, const Values& values) {
  TypedChannel channel{type, std::vector<std::byte>(values.size() * sizeof(values[0]))};
  std::memcpy(channel.bytes.data(), values.data(), channel.bytes.size());
  return channel;
}

/// A frame whose channels have types of their own, in scanlines or in tiles.
struct TypedFrame {
  Imf::Header header;  ///< windows, attributes and storage
  std::map<std::string, TypedChannel> channels;
};

/// The float channels of `part`, and room for others.
TypedFrame typed_frame(const FramePart& part);

/// Writes an EXR, one part for each frame.
void write_typed(const std::filesystem::path& path, std::vector<TypedFrame> frames);

/// One channel of an EXR: its type and its bits.
std::pair<Imf::PixelType, std::vector<std::byte>> stored(const std::filesystem::path& path,
                                                         const std::string& name, int part = 0);

}  // namespace ssdo::test
