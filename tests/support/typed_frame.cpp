// SPDX-License-Identifier: Apache-2.0
#include "support/typed_frame.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfTiledOutputPart.h>

#include "io/exr/exr_reader.h"

namespace ssdo::test {

TypedFrame typed_frame(const FramePart& part) {
  TypedFrame frame{part.extra, {}};
  frame.header.displayWindow() = box_of(part.display);
  frame.header.dataWindow() = box_of(part.data);
  frame.header.setType(Imf::SCANLINEIMAGE);
  if (!part.name.empty()) frame.header.setName(part.name);
  for (const auto& [name, plane] : part.channels)
    frame.channels[name] = typed(Imf::FLOAT, plane.pixels);
  return frame;
}

void write_typed(const std::filesystem::path& path, std::vector<TypedFrame> frames) {
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

std::pair<Imf::PixelType, std::vector<std::byte>> stored(const std::filesystem::path& path,
                                                         const std::string& name, int part) {
  const StoredChannel found = ExrReader(path).read_stored(part, std::vector{name})[0];
  return {found.channel.type, found.pixels};
}

}  // namespace ssdo::test
