// SPDX-License-Identifier: Apache-2.0
#include "fuzz/exr_sample.h"

#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputPart.h>
#include <ImfDeepTiledOutputPart.h>
#include <ImfFrameBuffer.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputPart.h>
#include <half.h>

#include <cmath>
#include <cstring>
#include <glm/vec3.hpp>
#include <optional>
#include <utility>

#include "scene/camera/camera.h"
#include "support/header_camera.h"

namespace ssdo::fuzz {
namespace {

/// Names that give a layer its role, and the components of its channels.
struct LayerRow {
  const char* name;
  const char* components;
};
constexpr LayerRow kPositions[] = {{"P.", "XYZ"}, {"ViewLayer.Position.", "XYZ"}, {"P.", "RGB"}};
constexpr LayerRow kOthers[] = {{"N.", "XYZ"},
                                {"ViewLayer.Normal.", "XYZ"},
                                {"", "RGBA"},
                                {"albedo.", "RGB"},
                                {"", "Z"},
                                {"ViewLayer.Depth.", "Z"},
                                {"motion.", "XY"},
                                {"ao.", "Y"},
                                {"crypto00.", "RGBA"},
                                {"right.P.", "XYZ"},
                                {"specular.", "RGB"},
                                {"roughness.", "R"}};
constexpr const char* kViews[] = {"left", "right", "main"};

/// What lies behind a pixel: a wavy surface before a pinhole at the origin that looks along -z.
struct Pixel {
  int x, y;
  float depth() const { return 4 + std::sin(0.7f * float(x)) + std::cos(0.9f * float(y)); }
  glm::vec3 position() const {
    constexpr float kFocalLength = 20;  // pixels
    const float d = depth();
    return {(float(x) - 7.5f) / kFocalLength * d, (7.5f - float(y)) / kFocalLength * d, -d};
  }
};

float value_of(const std::string& channel, const Pixel& pixel, Chance& chance) {
  if (chance.one_in(300)) return chance.pick(kOddFloats);
  const char component = channel.back();
  if (channel.find('P') != std::string::npos)
    return pixel.position()[component == 'X' || component == 'R'   ? 0
                            : component != 'Z' && component != 'B' ? 1
                                                                   : 2];
  if (channel.find('N') != std::string::npos) return component == 'Z' ? 1.0f : 0.0f;
  return component == 'Z' ? pixel.depth() : component == 'A' ? 1.0f : chance.share();
}

std::size_t bytes_of(Imf::PixelType type) { return type == Imf::HALF ? 2 : 4; }

void store(Imf::PixelType type, float value, char* to) {
  const half as_half(value);
  const auto as_uint = std::uint32_t(value >= 0 && value < 1e9f ? value : 0);
  if (type == Imf::HALF) std::memcpy(to, &as_half, sizeof as_half);
  if (type == Imf::FLOAT) std::memcpy(to, &value, sizeof value);
  if (type == Imf::UINT) std::memcpy(to, &as_uint, sizeof as_uint);
}

void add_layer(Imf::Header& header, const LayerRow& layer, Chance& chance, bool may_be_sampled) {
  constexpr Imf::PixelType kTypes[] = {Imf::HALF, Imf::FLOAT, Imf::FLOAT, Imf::UINT};
  const Imf::PixelType type = chance.pick(kTypes);
  const int sampling = may_be_sampled && chance.one_in(20) ? 2 : 1;
  for (const char* c = layer.components; *c; ++c)
    header.channels().insert(std::string(layer.name) + *c, Imf::Channel(type, sampling, sampling));
}

void add_camera(Imf::Header& header, Chance& chance) {
  Camera camera;
  camera.fx = camera.fy = 20, camera.cx = camera.cy = 8;
  const Window display{0, 0, 16, 16};
  constexpr auto kWriters = std::to_array(
      {test::standard_header, test::pbrt_header, test::vray_header, test::redshift_header});
  const int writer = chance.below(int(kWriters.size()) + 2);
  if (writer < int(kWriters.size())) {
    test::add_attributes(header, kWriters[std::size_t(writer)](camera, display),
                         chance.one_in(4) ? "exr/" : "");
  } else if (writer == int(kWriters.size())) {
    test::add_attributes(header, test::unreal_header({1, 2, 3, {4, 5, 6}}, camera, display), "",
                         true);
  }
}

Imf::Header make_header(const ExrKind& kind, int part, Chance& chance) {
  const int x = chance.one_in(4) ? 2 * chance.below(9) - 8 : 0, y = chance.one_in(4) ? -2 : 0;
  const Imath::Box2i data({x, y}, {x + 7 + 4 * chance.below(3), y + 3 + 4 * chance.below(6)}),
      display = chance.one_in(4) ? Imath::Box2i({0, 0}, {15, 15}) : data;
  Imf::Header header(display, data);
  header.compression() = kind.compression;
  header.setType(kind.deep    ? kind.tiled ? Imf::DEEPTILE : Imf::DEEPSCANLINE
                 : kind.tiled ? Imf::TILEDIMAGE
                              : Imf::SCANLINEIMAGE);
  if (kind.tiled)
    header.setTileDescription(Imf::TileDescription(chance.one_in(2) ? 4 : 16, 8, kind.levels));
  if (kind.parts > 1) header.setName("part" + std::to_string(part));
  if (chance.one_in(4)) header.setView(chance.pick(kViews));
  if (chance.one_in(8)) Imf::addMultiView(header, {"right", "left"});
  if (chance.one_in(4)) header.insert("Software", Imf::StringAttribute("Blender 4.2"));
  if (chance.one_in(2)) add_camera(header, chance);
  if (kind.deep) {
    for (const char* components : {"Z", "A"}) add_layer(header, {"", components}, chance, false);
    if (chance.one_in(2)) header.channels().insert("ZBack", header.channels()["Z"]);
    return header;
  }
  const bool may_be_sampled = !kind.tiled && x % 2 == 0;
  if (part == 0) add_layer(header, chance.pick(kPositions), chance, false);
  for (int count = 1 + chance.below(2); count > 0; --count)
    add_layer(header, chance.pick(kOthers), chance, may_be_sampled);
  return header;
}

/// The values of all channels over a window, as stored.
class FlatPixels {
 public:
  FlatPixels(const Imf::Header& header, const Imath::Box2i& window, Chance& chance) {
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
      const Imf::Channel& channel = c.channel();
      std::vector<char>& bytes = channels_.emplace_back();
      for (int y = window.min.y; y <= window.max.y; y += channel.ySampling) {
        for (int x = window.min.x; x <= window.max.x; x += channel.xSampling) {
          bytes.resize(bytes.size() + bytes_of(channel.type));
          store(channel.type, value_of(c.name(), {x, y}, chance),
                bytes.data() + bytes.size() - bytes_of(channel.type));
        }
      }
      buffer_.insert(c.name(), Imf::Slice::Make(channel.type, bytes.data(), window, 0, 0,
                                                channel.xSampling, channel.ySampling));
    }
  }
  const Imf::FrameBuffer& buffer() const { return buffer_; }

 private:
  std::vector<std::vector<char>> channels_;
  Imf::FrameBuffer buffer_;
};

/// No to three samples in each pixel of a window, and what they hold.
class DeepPixels {
 public:
  DeepPixels(const Imf::Header& header, Chance& chance) {
    const Imath::Box2i& window = header.dataWindow();
    const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
    const auto origin = [&](auto* first) {
      return reinterpret_cast<char*>(
          reinterpret_cast<std::uintptr_t>(first) -
          std::uintptr_t(std::ptrdiff_t(window.min.y) * width + window.min.x) * sizeof(*first));
    };
    counts_.resize(std::size_t(width) * std::size_t(height));
    for (unsigned& count : counts_) count = unsigned(chance.below(4));
    buffer_.insertSampleCountSlice(
        Imf::Slice(Imf::UINT, origin(counts_.data()), 4, 4 * std::size_t(width)));
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
      std::vector<char*>& places = add_channel(c.name(), c.channel().type, width, chance);
      buffer_.insert(
          c.name(), Imf::DeepSlice(c.channel().type, origin(places.data()), sizeof(char*),
                                   sizeof(char*) * std::size_t(width), bytes_of(c.channel().type)));
    }
  }
  const Imf::DeepFrameBuffer& buffer() const { return buffer_; }

 private:
  /// The addresses of its pixels' samples.
  std::vector<char*>& add_channel(const std::string& name, Imf::PixelType type, int width,
                                  Chance& chance) {
    constexpr std::size_t kMostSamples = 4;
    const std::size_t size = bytes_of(type);
    std::vector<char>& bytes =
        values_.emplace_back(std::vector<char>(counts_.size() * kMostSamples * size));
    std::vector<char*>& places = places_.emplace_back();
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      places.push_back(bytes.data() + i * kMostSamples * size);
      for (std::size_t k = 0; k < counts_[i]; ++k) {
        const Pixel pixel{int(i) % width, int(i) / width};
        store(type, value_of(name, pixel, chance) + 0.5f * float(k), places.back() + k * size);
      }
    }
    return places;
  }

  std::vector<unsigned> counts_;
  std::vector<std::vector<char>> values_;
  std::vector<std::vector<char*>> places_;
  Imf::DeepFrameBuffer buffer_;
};

/// All levels of the same pixels, in as many as each has.
void write_deep_tiles(Imf::MultiPartOutputFile& file, int index, Chance& chance) {
  Imf::DeepTiledOutputPart part(file, index);
  const DeepPixels pixels(part.header(), chance);
  part.setFrameBuffer(pixels.buffer());
  for (int ly = 0; ly < part.numYLevels(); ++ly) {
    for (int lx = 0; lx < part.numXLevels(); ++lx) {
      if (part.isValidLevel(lx, ly))
        part.writeTiles(0, part.numXTiles(lx) - 1, 0, part.numYTiles(ly) - 1, lx, ly);
    }
  }
}

void write_deep_lines(Imf::MultiPartOutputFile& file, int index, Chance& chance) {
  Imf::DeepScanLineOutputPart part(file, index);
  const DeepPixels pixels(part.header(), chance);
  part.setFrameBuffer(pixels.buffer());
  part.writePixels(part.header().dataWindow().max.y - part.header().dataWindow().min.y + 1);
}

void write_tiles(Imf::MultiPartOutputFile& file, int index, Chance& chance) {
  Imf::TiledOutputPart part(file, index);
  for (int ly = 0; ly < part.numYLevels(); ++ly) {
    for (int lx = 0; lx < part.numXLevels(); ++lx) {
      if (!part.isValidLevel(lx, ly)) continue;
      const FlatPixels pixels(part.header(), part.dataWindowForLevel(lx, ly), chance);
      part.setFrameBuffer(pixels.buffer());
      part.writeTiles(0, part.numXTiles(lx) - 1, 0, part.numYTiles(ly) - 1, lx, ly);
    }
  }
}

void write_lines(Imf::MultiPartOutputFile& file, int index, Chance& chance) {
  Imf::OutputPart part(file, index);
  const Imath::Box2i& window = part.header().dataWindow();
  const FlatPixels pixels(part.header(), window, chance);
  part.setFrameBuffer(pixels.buffer());
  part.writePixels(window.max.y - window.min.y + 1);
}

constexpr Imf::LevelMode kLevels[] = {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS};
constexpr Imf::Compression kDeepCompressions[] = {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION,
                                                  Imf::ZIPS_COMPRESSION};

/// That of one part of a file.
ExrKind kind_of_part(ExrKind kind, int part) {
  if (kind.deep_behind_flat) kind.deep = part > 0;
  return kind;
}

}  // namespace

std::vector<ExrKind> flat_kinds() {
  std::vector<ExrKind> kinds;
  for (int c = 0; c < Imf::NUM_COMPRESSION_METHODS; ++c) {
    const auto compression = Imf::Compression(c);
    for (const int parts : {1, 3}) {
      kinds.push_back({compression, false, false, Imf::ONE_LEVEL, parts});
      for (const Imf::LevelMode levels : kLevels)
        kinds.push_back({compression, false, true, levels, parts});
    }
  }
  return kinds;
}

std::vector<ExrKind> deep_kinds() {
  std::vector<ExrKind> kinds;
  for (const Imf::Compression compression : kDeepCompressions) {
    for (const int parts : {1, 2}) {
      kinds.push_back({compression, true, false, Imf::ONE_LEVEL, parts});
      for (const Imf::LevelMode levels : kLevels)
        kinds.push_back({compression, true, true, levels, parts});
    }
  }
  return kinds;
}

std::vector<ExrKind> mixed_kinds() {
  std::vector<ExrKind> kinds;
  for (const Imf::Compression compression : kDeepCompressions) {
    kinds.push_back({compression, false, false, Imf::ONE_LEVEL, 3, true});
    for (const Imf::LevelMode levels : kLevels)
      kinds.push_back({compression, false, true, levels, 3, true});
  }
  return kinds;
}

std::string exr_sample(const ExrKind& kind, Chance& chance) {
  std::vector<Imf::Header> headers;
  for (int i = 0; i < kind.parts; ++i) {
    headers.push_back(make_header(kind_of_part(kind, i), i, chance));
    headers[std::size_t(i)].displayWindow() = headers[0].displayWindow();  // parts share it
  }
  Imf::StdOSStream memory;
  {
    Imf::MultiPartOutputFile file(memory, headers.data(), int(headers.size()));
    for (int i = 0; i < kind.parts; ++i) {
      const bool deep = kind_of_part(kind, i).deep;
      if (deep && kind.tiled)
        write_deep_tiles(file, i, chance);
      else if (deep)
        write_deep_lines(file, i, chance);
      else if (kind.tiled)
        write_tiles(file, i, chance);
      else
        write_lines(file, i, chance);
    }
  }
  return memory.str();
}

std::vector<std::string> exr_samples(const std::vector<ExrKind>& kinds) {
  Chance chance(1);
  std::vector<std::string> all;
  for (const ExrKind& kind : kinds) all.push_back(exr_sample(kind, chance));
  return all;
}

}  // namespace ssdo::fuzz
