// SPDX-License-Identifier: Apache-2.0
#include "support/exr_fixture.h"

#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfDeepTiledOutputPart.h>

#include <cstdint>
#include <cstring>

namespace ssdo::test {

namespace {

void store(Imf::PixelType type, int value, std::byte* to) {
  const half as_half = half(float(value));
  const float as_float = float(value);
  const std::uint32_t as_uint = std::uint32_t(value);
  if (type == Imf::HALF) std::memcpy(to, &as_half, sizeof as_half);
  if (type == Imf::FLOAT) std::memcpy(to, &as_float, sizeof as_float);
  if (type == Imf::UINT) std::memcpy(to, &as_uint, sizeof as_uint);
}

}  // namespace

int test_value(int c, int x, int y) {
  const long long mixed = 7LL * x + 13LL * y + 29LL * c;
  return int((mixed % 509 + 509) % 509);
}

Imf::Header test_header(const Imath::Box2i& data_window, const std::vector<TestChannel>& channels,
                        Imf::Compression compression) {
  Imf::Header header(data_window, data_window);
  header.compression() = compression;
  header.setType(Imf::SCANLINEIMAGE);
  for (const TestChannel& c : channels) {
    header.channels().insert(c.name, Imf::Channel(c.type, c.sampling, c.sampling));
  }
  return header;
}

Imf::Header tiled(Imf::Header header, int tile_size, Imf::LevelMode mode) {
  header.setType(Imf::TILEDIMAGE);
  header.setTileDescription(Imf::TileDescription(tile_size, tile_size, mode));
  return header;
}

Imf::Header named(Imf::Header header, const std::string& name) {
  header.setName(name);
  return header;
}

TestPixels::TestPixels(const Imf::Header& header, const Imath::Box2i& window) {
  int index = 0;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c, ++index) {
    const Imf::Channel& channel = c.channel();
    const std::size_t size = channel.type == Imf::HALF ? 2 : 4;
    std::vector<std::byte>& bytes = channels_.emplace_back();
    for (int y = window.min.y; y <= window.max.y; y += channel.ySampling) {
      for (int x = window.min.x; x <= window.max.x; x += channel.xSampling) {
        bytes.resize(bytes.size() + size);
        store(channel.type, test_value(index, x, y), &bytes[bytes.size() - size]);
      }
    }
    frame_buffer_.insert(c.name(), Imf::Slice::Make(channel.type, bytes.data(), window, 0, 0,
                                                    channel.xSampling, channel.ySampling));
  }
}

void write_lines(Imf::MultiPartOutputFile& file, int index) {
  Imf::OutputPart part(file, index);
  const TestPixels pixels(part.header(), part.header().dataWindow());
  part.setFrameBuffer(pixels.frame_buffer());
  part.writePixels(part.header().dataWindow().max.y - part.header().dataWindow().min.y + 1);
}

void write_tiles(Imf::MultiPartOutputFile& file, int index) {
  Imf::TiledOutputPart part(file, index);
  for (int ly = 0; ly < part.numYLevels(); ++ly) {
    for (int lx = 0; lx < part.numXLevels(); ++lx) {
      if (part.header().tileDescription().mode != Imf::RIPMAP_LEVELS && lx != ly) continue;
      const TestPixels pixels(part.header(), part.dataWindowForLevel(lx, ly));
      part.setFrameBuffer(pixels.frame_buffer());
      part.writeTiles(0, part.numXTiles(lx) - 1, 0, part.numYTiles(ly) - 1, lx, ly);
    }
  }
}

namespace {

/// One sample in every pixel, of the value 1 in every channel.
class DeepTestPixels {
 public:
  explicit DeepTestPixels(const Imf::Header& header) {
    const Imath::Box2i window = header.dataWindow();
    const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
    counts_.assign(std::size_t(width) * height, 1);
    samples_.assign(counts_.size(), &sample_);
    const auto at_origin = [&](void* first, std::size_t size) {
      return static_cast<char*>(first) -
             (std::ptrdiff_t(window.min.y) * width + window.min.x) * std::ptrdiff_t(size);
    };
    frame_buffer_.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, at_origin(counts_.data(), 4), 4, std::size_t(width) * 4));
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
      frame_buffer_.insert(c.name(),
                           Imf::DeepSlice(Imf::FLOAT, at_origin(samples_.data(), sizeof(float*)),
                                          sizeof(float*), width * sizeof(float*), sizeof(float)));
    }
  }
  const Imf::DeepFrameBuffer& frame_buffer() const { return frame_buffer_; }

 private:
  float sample_ = 1;
  std::vector<unsigned> counts_;
  std::vector<float*> samples_;
  Imf::DeepFrameBuffer frame_buffer_;
};

}  // namespace

void write_deep_lines(Imf::MultiPartOutputFile& file, int index) {
  Imf::DeepScanLineOutputPart part(file, index);
  const DeepTestPixels pixels(part.header());
  part.setFrameBuffer(pixels.frame_buffer());
  part.writePixels(part.header().dataWindow().max.y - part.header().dataWindow().min.y + 1);
}

void write_deep_tiles(Imf::MultiPartOutputFile& file, int index) {
  Imf::DeepTiledOutputPart part(file, index);
  const DeepTestPixels pixels(part.header());
  part.setFrameBuffer(pixels.frame_buffer());
  for (int ly = 0; ly < part.numYLevels(); ++ly) {
    for (int lx = 0; lx < part.numXLevels(); ++lx) {
      if (part.isValidLevel(lx, ly))
        part.writeTiles(0, part.numXTiles(lx) - 1, 0, part.numYTiles(ly) - 1, lx, ly);
    }
  }
}

void write_test_exr(const std::filesystem::path& path, const std::vector<Imf::Header>& headers) {
  Imf::MultiPartOutputFile file(path.c_str(), headers.data(), int(headers.size()));
  for (int i = 0; i < int(headers.size()); ++i) {
    const std::string& type = headers[std::size_t(i)].type();
    if (type == Imf::TILEDIMAGE)
      write_tiles(file, i);
    else if (type == Imf::DEEPSCANLINE)
      write_deep_lines(file, i);
    else if (type == Imf::DEEPTILE)
      write_deep_tiles(file, i);
    else
      write_lines(file, i);
  }
}

}  // namespace ssdo::test
