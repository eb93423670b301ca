// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfTiledOutputPart.h>

#include <cstring>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "io/exr_reader.h"
#include "support/exr_fixture.h"
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
inline TypedFrame typed_frame(const FramePart& part) {
  TypedFrame frame{part.extra, {}};
  frame.header.displayWindow() = box_of(part.display);
  frame.header.dataWindow() = box_of(part.data);
  frame.header.setType(Imf::SCANLINEIMAGE);
  if (!part.name.empty()) frame.header.setName(part.name);
  for (const auto& [name, plane] : part.channels)
    frame.channels[name] = typed(Imf::FLOAT, plane.pixels);
  return frame;
}

inline void write_typed(const std::filesystem::path& path, std::vector<TypedFrame> frames) {
  std::vector<Imf::Header> headers;
  for (TypedFrame& frame : frames) {
    for (const auto& [name, channel] : frame.channels)
      frame.header.channels().insert(name, Imf::Channel(channel.type));
    headers.push_back(frame.header);
  }
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), int(headers.size()));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Imath::Box2i window = headers[i].dataWindow();
    Imf::FrameBuffer buffer;
    for (const auto& [name, channel] : frames[i].channels)
      buffer.insert(name, Imf::Slice::Make(channel.type, channel.bytes.data(), window));
    if (headers[i].type() == Imf::TILEDIMAGE) {
      Imf::TiledOutputPart part(file, int(i));
      part.setFrameBuffer(buffer);
      part.writeTiles(0, part.numXTiles() - 1, 0, part.numYTiles() - 1);
    } else {
      Imf::OutputPart part(file, int(i));
      part.setFrameBuffer(buffer);
      part.writePixels(window.max.y - window.min.y + 1);
    }
  }
}

/// One channel of an EXR: its type and its bits.
inline std::pair<Imf::PixelType, std::vector<std::byte>> stored(const std::filesystem::path& path,
                                                                const std::string& name,
                                                                int part = 0) {
  const StoredChannel found = ExrReader(path).read_stored(part, std::vector{name})[0];
  return {found.channel.type, found.pixels};
}

}  // namespace ssdo::test
