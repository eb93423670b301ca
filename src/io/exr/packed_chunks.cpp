// SPDX-License-Identifier: Apache-2.0
#include "io/exr/packed_chunks.h"

#include <ImfMultiPartInputFile.h>
#include <ImfVersion.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <utility>

#include "io/exr/attribute_sizes.h"
#include "io/exr/exr_parts.h"

namespace ssdo {
namespace {

/// A number as files have it, little endian; 0 where the file ends.
template <class Number>
Number read_number(std::istream& in) {
  unsigned char bytes[sizeof(Number)] = {};
  in.read(reinterpret_cast<char*>(bytes), sizeof bytes);
  Number number = 0;
  for (std::size_t i = 0; i < sizeof bytes; ++i) number |= Number(bytes[i]) << (8 * i);
  return number;
}

std::uint64_t divide_up(std::uint64_t a, std::uint64_t b) { return (a + b - 1) / b; }

/// The numbers of tiles along one side at each level, where `largest` is the side that the levels
/// halve down to one pixel.
std::vector<std::uint64_t> tiles_of_levels(std::uint64_t side, std::uint64_t tile,
                                           std::uint64_t largest, Imf::LevelRoundingMode rounding) {
  const auto at_level = [&](std::uint64_t pixels, int level) {
    const std::uint64_t step = std::uint64_t(1) << level;
    return std::max(std::uint64_t(1),
                    rounding == Imf::ROUND_UP ? divide_up(pixels, step) : pixels / step);
  };
  std::vector<std::uint64_t> tiles = {divide_up(side, tile)};
  for (int level = 1; at_level(largest, level - 1) > 1; ++level)
    tiles.push_back(divide_up(at_level(side, level), tile));
  return tiles;
}

/// Of all levels, as many as there are places in the part's table.
std::uint64_t count_chunks(const ExrPart& part) {
  const auto width = std::uint64_t(part.data_window.width()),
             height = std::uint64_t(part.data_window.height());
  if (!is_tiled(part))
    return divide_up(height, std::uint64_t(lines_per_chunk(part.header.compression())));
  const Imf::TileDescription& tile = part.header.tileDescription();
  if (tile.mode == Imf::ONE_LEVEL)
    return divide_up(width, tile.xSize) * divide_up(height, tile.ySize);
  const bool mipmap = tile.mode == Imf::MIPMAP_LEVELS;
  const std::uint64_t largest = std::max(width, height);
  const auto columns =
      tiles_of_levels(width, tile.xSize, mipmap ? largest : width, tile.roundingMode);
  const auto rows =
      tiles_of_levels(height, tile.ySize, mipmap ? largest : height, tile.roundingMode);
  if (mipmap)
    return std::inner_product(columns.begin(), columns.end(), rows.begin(), std::uint64_t(0));
  return std::accumulate(columns.begin(), columns.end(), std::uint64_t(0)) *
         std::accumulate(rows.begin(), rows.end(), std::uint64_t(0));
}

/// What stands before the bytes of a chunk.
struct Head {
  const ExrPart* part = nullptr;  ///< none: there is no chunk
  std::int32_t x = 0, y = 0;      ///< the column and row of a tile, or the first scanline
  bool full_resolution = true;
  std::uint64_t bytes = 0;    ///< of a flat chunk, or of a deep one's table of sample counts
  std::uint64_t samples = 0;  ///< the bytes of a deep chunk's samples, which follow
};

/// Leaves the stream at the bytes of the chunk.
Head read_head(std::istream& in, const ExrReader& file) {
  const std::size_t part =
      Imf::isMultiPart(file.file().version()) ? read_number<std::uint32_t>(in) : 0;
  if (part >= file.parts().size()) return {};
  Head head{&file.parts()[part]};
  if (is_tiled(*head.part)) head.x = std::int32_t(read_number<std::uint32_t>(in));
  head.y = std::int32_t(read_number<std::uint32_t>(in));
  if (is_tiled(*head.part)) head.full_resolution = read_number<std::uint64_t>(in) == 0;
  if (head.part->deep) {
    head.bytes = read_number<std::uint64_t>(in);
    head.samples = read_number<std::uint64_t>(in);
    read_number<std::uint64_t>(in);  // the bytes of the samples when unpacked
  } else {
    head.bytes = read_number<std::uint32_t>(in);
  }
  return in ? head : Head();
}

}  // namespace

PackedChunks::PackedChunks(const ExrReader& file, const ExrPart& part)
    : file_(file),
      part_(part),
      width_(part.data_window.width()),
      height_(lines_per_chunk(part.header.compression())),
      in_(file.path(), std::ios::binary) {
  if (is_tiled(part)) {
    // The file may claim sides that no int holds.
    const Imf::TileDescription& tile = part.header.tileDescription();
    width_ = int(std::min(tile.xSize, unsigned(part.data_window.width())));
    height_ = int(std::min(tile.ySize, unsigned(part.data_window.height())));
  }
  columns_ = (part.data_window.width() - 1) / width_ + 1;
  rows_ = (part.data_window.height() - 1) / height_ + 1;
  read_table();
  const auto is_complete = [&](const ExrPart& p) { return file.file().partComplete(p.index); };
  if (!std::ranges::all_of(file.parts(), is_complete)) search();
}

std::size_t PackedChunks::first(int y0) const {
  return std::size_t((y0 - part_.data_window.y0) / height_) * std::size_t(columns_);
}

std::size_t PackedChunks::end(int y1) const { return first(y1 - 1) + std::size_t(columns_); }

Window PackedChunks::window(std::size_t chunk) const {
  const Window& all = part_.data_window;
  const int x = all.x0 + int(chunk % std::size_t(columns_)) * width_,
            y = all.y0 + int(chunk / std::size_t(columns_)) * height_;
  return {x, y, std::min(all.x1 - x, width_) + x, std::min(all.y1 - y, height_) + y};
}

std::optional<std::vector<std::byte>> PackedChunks::read(std::size_t chunk,
                                                         std::size_t most) const {
  const std::lock_guard lock(mutex_);
  if (places_[chunk] == 0) return std::nullopt;
  in_.clear();
  in_.seekg(std::streamoff(places_[chunk]));
  const Head head = read_head(in_, file_);
  if (head.part != &part_ || head.bytes > most) return std::nullopt;
  std::vector<std::byte> bytes(head.bytes);
  in_.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(bytes.size()));
  return in_ ? std::optional(std::move(bytes)) : std::nullopt;
}

/// The tables of all parts stand one after another, each with the full resolution first.
void PackedChunks::read_table() {
  const std::uint64_t tables = check_attribute_sizes(file_.path());
  for (const ExrPart& part : file_.parts()) {
    if (&part == &part_) in_.seekg(std::streamoff(tables + 8 * all_chunks_));
    all_chunks_ += count_chunks(part);
  }
  first_chunk_ = tables + 8 * all_chunks_;
  places_.resize(count());
  for (std::uint64_t& place : places_) place = read_number<std::uint64_t>(in_);
}

/// Goes from chunk to chunk, as OpenEXR does where a table is incomplete.
void PackedChunks::search() {
  const std::uint64_t size = std::filesystem::file_size(file_.path());
  in_.clear();
  std::uint64_t place = first_chunk_;
  for (std::uint64_t i = 0; i < all_chunks_; ++i) {
    in_.seekg(std::streamoff(place));
    const Head head = read_head(in_, file_);
    if (!head.part || head.bytes > size || head.samples > size) return;
    const std::int64_t row =
        is_tiled(part_) ? head.y : (std::int64_t(head.y) - part_.data_window.y0) / height_;
    if (head.part == &part_ && head.full_resolution && head.x >= 0 && head.x < columns_ &&
        row >= 0 && row < rows_)
      places_[std::size_t(row) * std::size_t(columns_) + std::size_t(head.x)] = place;
    place = std::uint64_t(in_.tellg()) + head.bytes + head.samples;
  }
}

}  // namespace ssdo
