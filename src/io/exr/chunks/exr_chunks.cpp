// SPDX-License-Identifier: Apache-2.0
#include "io/exr/chunks/exr_chunks.h"

#include <IexBaseExc.h>
#include <ImfFrameBuffer.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfTiledInputPart.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "io/exr/chunks/chunk_sizes.h"
#include "io/exr/chunks/deep_chunks.h"
#include "io/exr/chunks/packed_chunks.h"
#include "io/exr/file/exr_parts.h"

namespace ssdo {
namespace {

Imf::FrameBuffer slices_over(const Window& rows, std::span<const ChannelRows> channels) {
  Imf::FrameBuffer slices;
  const Imath::Box2i box({rows.x0, rows.y0}, {rows.x1 - 1, rows.y1 - 1});
  for (const auto& [channel, pixels, as_float] : channels) {
    slices.insert(channel.name, Imf::Slice::Make(as_float ? Imf::FLOAT : channel.type, pixels, box,
                                                 0, 0, channel.x_sampling, channel.y_sampling));
  }
  return slices;
}

void read_lines(const ExrFile& file, const ExrPart& part, const Window& rows,
                std::span<const ChannelRows> channels, const MissingChunks& missing) {
  Imf::InputPart lines(file.file(), part.index);
  lines.setFrameBuffer(slices_over(rows, channels));
  int y = rows.y0;
  for (const Window& gap : missing.windows) {
    const int end = std::min(gap.y0, rows.y1);
    if (y < end) lines.readPixels(y, end - 1);
    y = std::max(y, gap.y1);
  }
  if (y < rows.y1) lines.readPixels(y, rows.y1 - 1);
}

/// The tiles of the full-resolution level.
class Tiles {
 public:
  Tiles(const ExrFile& file, const ExrPart& part) : tiles_(file.file(), part.index) {}

  int columns() const { return tiles_.numXTiles(0); }
  Window window(int x, int y) const { return window_of(tiles_.dataWindowForTile(x, y, 0)); }

  void read_one(int x, int y, const Window& window, std::span<const ChannelRows> channels) {
    tiles_.setFrameBuffer(slices_over(window, channels));
    tiles_.readTile(x, y, 0);
  }

  /// `first` to `last` are rows of tiles, which cover `window`.
  void read(int first, int last, const Window& window, std::span<const ChannelRows> channels,
            const MissingChunks& missing) {
    tiles_.setFrameBuffer(slices_over(window, channels));
    if (missing.windows.empty()) return tiles_.readTiles(0, columns() - 1, first, last);
    for (int y = first; y <= last; ++y) {
      for (int x = 0; x < columns(); ++x) {
        if (!is_missing(missing, this->window(x, y))) tiles_.readTile(x, y, 0);
      }
    }
  }

 private:
  Imf::TiledInputPart tiles_;
};

/// Where `rows` begin or end within tiles, whole tiles go through a buffer of their own.
void read_tiles(const ExrFile& file, const ExrPart& part, const Window& rows,
                std::span<const ChannelRows> channels, const MissingChunks& missing) {
  Tiles tiles(file, part);
  const int height = int(part.header.tileDescription().ySize), top = part.data_window.y0,
            first = (rows.y0 - top) / height, last = (rows.y1 - 1 - top) / height;
  const Window whole{rows.x0, tiles.window(0, first).y0, rows.x1, tiles.window(0, last).y1};
  if (whole == rows) return tiles.read(first, last, rows, channels, missing);
  std::vector<std::vector<std::byte>> planes;
  std::vector<ChannelRows> to_planes(channels.begin(), channels.end());
  const auto line_bytes = [&](const ChannelRows& to) {
    return std::size_t(rows.width()) * (to.as_float ? sizeof(float) : bytes_of(to.channel.type));
  };
  const auto above = std::size_t(rows.y0 - whole.y0);
  for (ChannelRows& to : to_planes) {
    auto& plane = planes.emplace_back(std::size_t(whole.height()) * line_bytes(to));
    // Pixels of missing tiles keep their present values.
    std::memcpy(&plane[above * line_bytes(to)], to.pixels,
                std::size_t(rows.height()) * line_bytes(to));
    to.pixels = plane.data();
  }
  tiles.read(first, last, whole, to_planes, missing);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const std::size_t line = line_bytes(channels[i]);
    std::memcpy(channels[i].pixels, &planes[i][above * line], std::size_t(rows.height()) * line);
  }
}

void try_flat_chunk(const ExrFile& file, const ExrPart& part, const PackedChunks& chunks,
                    std::size_t chunk) {
  const Window window = chunks.window(chunk);
  const auto columns = std::size_t(chunks.columns());
  std::vector<std::byte> pixels(4 * window.area());
  const ChannelRows first{part.channels[0], pixels.data(), false};
  if (is_tiled(part))
    Tiles(file, part).read_one(int(chunk % columns), int(chunk / columns), window, {&first, 1});
  else
    read_lines(file, part, window, {&first, 1}, {});
}

/// Whether a chunk can be read. Reading one channel is enough: all of them are packed together.
bool can_read(const ExrFile& file, const ExrPart& part, const PackedChunks& chunks,
              std::size_t chunk) {
  try {
    check_chunk_size(part, chunks, chunk);
    if (part.deep)
      try_deep_chunk(file, part, chunks.window(chunk));
    else
      try_flat_chunk(file, part, chunks, chunk);
    return true;
  } catch (const std::exception& error) {
    throw_unless_of_file(error);
    // After an IoExc no recovery is needed: OpenEXR read the bytes and could not decode them. A
    // recovery opens the part again; its time grows with the number of chunks.
    const bool asked = dynamic_cast<const Iex::BaseExc*>(&error);
    if (asked && !dynamic_cast<const Iex::IoExc*>(&error)) file.recover();
    return false;
  }
}

}  // namespace

MissingChunks find_missing_chunks(const ExrFile& file, const ExrPart& part) {
  if (!Imf::isSupportedType(part.header.type())) return {};  // never read
  const PackedChunks chunks(file, part);
  MissingChunks missing{{}, chunks.count()};
  for (std::size_t chunk = 0; chunk < chunks.count(); ++chunk)
    if (!can_read(file, part, chunks, chunk)) missing.windows.push_back(chunks.window(chunk));
  return missing;
}

void read_chunks(const ExrFile& file, const ExrPart& part, const Window& rows,
                 std::span<const ChannelRows> channels, const MissingChunks& missing) {
  check_chunk_sizes(file, part, rows, missing);
  if (is_tiled(part))
    read_tiles(file, part, rows, channels, missing);
  else
    read_lines(file, part, rows, channels, missing);
}

}  // namespace ssdo
