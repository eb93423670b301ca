// SPDX-License-Identifier: Apache-2.0
#include "io/exr/file/exr_parts.h"

#include <ImfChannelList.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "io/size_guard.h"

namespace ssdo {
namespace {

/// The bytes of all channels of a row of tiles, which OpenEXR allocates even where the image is
/// smaller than a tile. 0 for scanlines.
double tile_row_bytes(const ExrPart& part) {
  if (!is_tiled(part)) return 0;
  const Imf::TileDescription& tiles = part.header.tileDescription();
  return bytes_per_pixel(part) * std::max(double(part.data_window.width()), double(tiles.xSize)) *
         double(tiles.ySize);
}

/// The lines of a chunk, as OpenEXR reports them for a compression. Earlier releases report none,
/// and the only compressions of theirs that come here have one line.
template <class Compression>
int lines_as_told(Compression compression) {
  if constexpr (requires { getCompressionNumScanlines(compression); })
    return getCompressionNumScanlines(compression);
  else
    return 1;
}

}  // namespace

Window window_of(const Imath::Box2i& box) {
  return {box.min.x, box.min.y, box.max.x + 1, box.max.y + 1};
}

int lines_per_chunk(Imf::Compression compression) {
  switch (compression) {
    case Imf::ZIP_COMPRESSION:
    case Imf::PXR24_COMPRESSION:
      return 16;
    case Imf::PIZ_COMPRESSION:
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION:
      return 32;
    case Imf::DWAB_COMPRESSION:
      return 256;
    default:
      return lines_as_told(compression);
  }
}

double bytes_per_pixel(const ExrPart& part) {
  double bytes = 0;
  for (const ExrChannel& c : part.channels) bytes += double(bytes_of(c.type));
  return bytes;
}

ExrPart describe_part(const Imf::MultiPartInputFile& file, int index) {
  ExrPart part;
  part.index = index;
  part.header = file.header(index);
  const Imf::Header& header = part.header;
  if (header.hasName()) part.name = header.name();
  if (header.hasView()) part.view = header.view();
  part.deep = header.hasType() && Imf::isDeepData(header.type());
  part.data_window = window_of(header.dataWindow());
  part.display_window = window_of(header.displayWindow());
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
    part.channels.push_back(
        {c.name(), c.channel().type, c.channel().xSampling, c.channel().ySampling});
    // OpenEXR does not check the sampling in a part whose type it does not know.
    const ExrChannel& channel = part.channels.back();
    if (channel.x_sampling < 1 || channel.y_sampling < 1) {
      throw std::runtime_error(fmt::format("channel '{}' is subsampled {}x{}", channel.name,
                                           channel.x_sampling, channel.y_sampling));
    }
  }
  return part;
}

std::string string_attribute(const Imf::Header& header, const std::string& name) {
  const auto* found = header.findTypedAttribute<Imf::StringAttribute>(name);
  return found ? found->value() : "";
}

int int_attribute(const Imf::Header& header, const std::string& name) {
  const auto* found = header.findTypedAttribute<Imf::IntAttribute>(name);
  return found ? found->value() : 0;
}

std::vector<std::string> views_of(const Imf::Header& header) {
  return Imf::hasMultiView(header) ? Imf::multiView(header) : std::vector<std::string>();
}

std::string label(const ExrPart& part) {
  return part.name.empty() ? fmt::format("part {}", part.index)
                           : fmt::format("part {} '{}'", part.index, part.name);
}

bool is_tiled(const ExrPart& part) {
  return part.header.hasType() && Imf::isTiled(part.header.type());
}

double pixels_per_chunk(const ExrPart& part) {
  if (is_tiled(part)) {
    const Imf::TileDescription& tiles = part.header.tileDescription();
    return double(tiles.xSize) * double(tiles.ySize);
  }
  return double(part.data_window.width()) * lines_per_chunk(part.header.compression());
}

double largest_ratio(const ExrPart& part) {
  constexpr double kFloatOverHalf = 2;
  switch (part.header.compression()) {
    case Imf::NO_COMPRESSION:
      return kFloatOverHalf;
    case Imf::RLE_COMPRESSION:
      return kFloatOverHalf * 64;  // a run of 128 in two bytes
    case Imf::ZIPS_COMPRESSION:
    case Imf::ZIP_COMPRESSION:
      return kFloatOverHalf * 1032;  // deflate
    default:
      return kLargestRatio;
  }
}

double decoder_bytes(const ExrPart& part) {
  return bytes_per_pixel(part) * pixels_per_chunk(part) * 2 * std::max(1, Imf::globalThreadCount());
}

double float_bytes(const ExrChannel& channel) {
  return 4.0 / (double(channel.x_sampling) * channel.y_sampling);
}

double claimed_bytes(const ExrPart& part, double value_bytes) {
  constexpr double kLargeTiles = 1 << 28;  // bytes; below, a tile may well be larger than its image
  const double tiles = tile_row_bytes(part), pixels = double(part.data_window.area()) * value_bytes;
  return tiles > kLargeTiles ? std::max(pixels, tiles) : pixels;
}

void take_out(Imf::Header& header, const std::string& name) {
  if (header.find(name) == header.end()) return;
  Imf::Header rest;
  for (auto attribute = header.begin(); attribute != header.end(); ++attribute) {
    if (attribute.name() != name) rest.insert(attribute.name(), attribute.attribute());
  }
  header = rest;
}

std::string text_of(const Window& w) {
  return fmt::format("{},{} to {},{}", w.x0, w.y0, w.x1 - 1, w.y1 - 1);
}

}  // namespace ssdo
