// SPDX-License-Identifier: Apache-2.0
#include "io/exr/packed_chunks.h"

#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfVersion.h>

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "io/exr/exr_parts.h"

namespace ssdo {
namespace {

/// Numbers that stand one after another, little endian; 0 where the file ends.
class Numbers {
 public:
  Numbers(const InputFile& file, std::uint64_t place, std::size_t bytes) : bytes_(bytes) {
    end_ = file.read(place, bytes_);
  }

  template <class Number>
  Number next() {
    Number number = 0;
    if (sizeof(Number) <= end_ - at_) {
      for (std::size_t i = 0; i < sizeof(Number); ++i)
        number |= Number(std::to_integer<Number>(bytes_[at_ + i]) << (8 * i));
      at_ += sizeof(Number);
    } else {
      are_all_ = false, at_ = end_;
    }
    return number;
  }

  std::size_t taken() const { return at_; }  ///< bytes
  bool are_all() const { return are_all_; }  ///< the file has not ended before

 private:
  std::vector<std::byte> bytes_;
  std::size_t at_ = 0, end_;
  bool are_all_ = true;
};

/// Of what stands before the bytes of a chunk, at most: part, column, row, two levels, and three
/// sizes of eight bytes.
constexpr std::size_t kHeadBytes = 5 * 4 + 3 * 8;

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

/// The numbers of tiles at each level. Those of mip maps are as many for columns as for rows.
struct TileCounts {
  std::vector<std::uint64_t> columns, rows;

  explicit TileCounts(const ExrPart& part) {
    const Imf::TileDescription& tile = part.header.tileDescription();
    const auto width = std::uint64_t(part.data_window.width()),
               height = std::uint64_t(part.data_window.height());
    if (tile.mode == Imf::ONE_LEVEL) {
      columns = {divide_up(width, tile.xSize)}, rows = {divide_up(height, tile.ySize)};
      return;
    }
    const bool mipmap = tile.mode == Imf::MIPMAP_LEVELS;
    const std::uint64_t largest = std::max(width, height);
    columns = tiles_of_levels(width, tile.xSize, mipmap ? largest : width, tile.roundingMode);
    rows = tiles_of_levels(height, tile.ySize, mipmap ? largest : height, tile.roundingMode);
  }
};

/// Of all levels, as many as there are places in the part's table. A part of a type that OpenEXR
/// does not know says so itself.
std::uint64_t count_chunks(const ExrPart& part) {
  if (!Imf::isSupportedType(part.header.type())) return std::uint64_t(part.header.chunkCount());
  if (!is_tiled(part)) {
    return divide_up(std::uint64_t(part.data_window.height()),
                     std::uint64_t(lines_per_chunk(part.header.compression())));
  }
  const auto [columns, rows] = TileCounts(part);
  if (part.header.tileDescription().mode == Imf::MIPMAP_LEVELS)
    return std::inner_product(columns.begin(), columns.end(), rows.begin(), std::uint64_t(0));
  return std::accumulate(columns.begin(), columns.end(), std::uint64_t(0)) *
         std::accumulate(rows.begin(), rows.end(), std::uint64_t(0));
}

bool is_multi_part(const ExrReader& file) { return Imf::isMultiPart(file.file().version()); }

/// Of a chunk that stands in several places.
constexpr std::uint64_t kNowhere = ~std::uint64_t(0);

}  // namespace

/// What stands before the bytes of a chunk.
struct PackedChunks::Head {
  const ExrPart* part = nullptr;  ///< none: there is no chunk
  std::int32_t x = 0, y = 0;      ///< the column and row of a tile, or the first scanline
  std::int32_t x_level = 0, y_level = 0;
  std::uint64_t bytes = 0;    ///< of a flat chunk, or of a deep one's table of sample counts
  std::uint64_t samples = 0;  ///< the bytes of a deep chunk's samples, which follow
  std::uint64_t place = 0;    ///< where the bytes begin

  std::uint64_t end() const { return place + bytes + samples; }
  bool is_full_resolution() const { return x_level == 0 && y_level == 0; }

  /// Whether the part has such a scanline or tile. The rows of mip maps are those of the level that
  /// the columns have.
  bool is_in_part() const {
    if (!is_tiled(*part)) return y >= part->data_window.y0 && y < part->data_window.y1;
    if (std::min({x, y, x_level, y_level}) < 0) return false;
    const auto [columns, rows] = TileCounts(*part);
    const bool mipmap = part->header.tileDescription().mode == Imf::MIPMAP_LEVELS;
    const auto across = std::size_t(x_level), down = std::size_t(mipmap ? x_level : y_level);
    return across < columns.size() && std::size_t(y_level) < rows.size() &&
           std::uint64_t(x) < columns[across] && std::uint64_t(y) < rows[down];
  }
};

PackedChunks::PackedChunks(const ExrReader& file, const ExrPart& part)
    : file_(file),
      part_(part),
      width_(part.data_window.width()),
      height_(lines_per_chunk(part.header.compression())),
      size_(file.input().bytes()) {
  if (!Imf::isSupportedType(part.header.type())) throw std::runtime_error("its type is unknown");
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

std::vector<std::byte> PackedChunks::read(std::size_t chunk, std::size_t most) const {
  check_is_next(chunk, most);
  const Head head = head_of(chunk);
  if (!head.part) throw std::runtime_error("a chunk is missing or cut short");
  if (!is_of(head, chunk)) throw std::runtime_error("a chunk stands in the place of another");
  check_size(head, most);
  std::vector<std::byte> bytes(head.bytes);
  if (file_.input().read(head.place, bytes) < bytes.size())
    throw std::runtime_error("a chunk is cut short");
  return bytes;
}

void PackedChunks::check_smaller_levels(std::size_t most) const {
  for (const std::uint64_t place : smaller_places_) {
    const Head head = place == 0 ? Head() : head_at(place);
    if (head.part == &part_) check_size(head, most);  // of the others OpenEXR says it itself
  }
}

void PackedChunks::check_size(const Head& head, std::size_t most) const {
  if (head.bytes > most) throw std::runtime_error("a chunk claims more bytes than its pixels take");
  if (head.bytes > size_ - head.place || head.samples > size_ - head.place - head.bytes)
    throw std::runtime_error("a chunk is cut short");
}

/// The tables of all parts stand one after another, each with the full resolution first.
void PackedChunks::read_table() {
  std::uint64_t table = 0;
  for (const ExrPart& part : file_.parts()) {
    if (&part == &part_) table = file_.tables() + 8 * all_chunks_;
    all_chunks_ += count_chunks(part);
  }
  first_chunk_ = file_.tables() + 8 * all_chunks_;
  places_.resize(count());
  smaller_places_.resize(count_chunks(part_) - count());
  Numbers numbers(file_.input(), table, std::min(8 * count_chunks(part_), size_));
  for (std::uint64_t& place : places_) place = numbers.next<std::uint64_t>();
  for (std::uint64_t& place : smaller_places_) place = numbers.next<std::uint64_t>();
}

/// Goes from chunk to chunk, as OpenEXR does where a table is incomplete, and as far. OpenEXR may
/// take what the table says, or the first of two places.
/// Source: OpenEXR 3.1, ImfMultiPartInputFile.cpp, chunkOffsetReconstruction().
void PackedChunks::search() {
  std::uint64_t next = first_chunk_;
  for (std::uint64_t i = 0; i < all_chunks_; ++i) {
    const Head head = head_at(next);
    if (!head.part || !head.is_in_part()) return;
    if (head.part == &part_) add_place(head, next);
    if (head.bytes > size_ || head.samples > size_) return;
    next = head.end();
  }
}

/// Of a chunk of this part that was found in the file.
void PackedChunks::add_place(const Head& head, std::uint64_t found) {
  if (!head.is_full_resolution()) return smaller_places_.push_back(found);
  const std::int64_t row =
      is_tiled(part_) ? head.y : (std::int64_t(head.y) - part_.data_window.y0) / height_;
  std::uint64_t& place = places_[std::size_t(row) * std::size_t(columns_) + std::size_t(head.x)];
  place = place == 0 || place == found ? found : kNowhere;
}

PackedChunks::Head PackedChunks::head_at(std::uint64_t place) const {
  Numbers numbers(file_.input(), place, kHeadBytes);
  const std::size_t part = is_multi_part(file_) ? numbers.next<std::uint32_t>() : 0;
  if (part >= file_.parts().size()) return {};
  Head head{&file_.parts()[part]};
  if (is_tiled(*head.part)) head.x = std::int32_t(numbers.next<std::uint32_t>());
  head.y = std::int32_t(numbers.next<std::uint32_t>());
  if (is_tiled(*head.part)) {
    head.x_level = std::int32_t(numbers.next<std::uint32_t>());
    head.y_level = std::int32_t(numbers.next<std::uint32_t>());
  }
  if (head.part->deep) {
    head.bytes = numbers.next<std::uint64_t>();
    head.samples = numbers.next<std::uint64_t>();
    numbers.next<std::uint64_t>();  // the bytes of the samples when unpacked
  } else {
    head.bytes = numbers.next<std::uint32_t>();
  }
  if (!numbers.are_all()) return {};
  head.place = place + numbers.taken();
  return head;
}

PackedChunks::Head PackedChunks::head_of(std::size_t chunk) const {
  return places_[chunk] == 0 ? Head() : head_at(places_[chunk]);
}

bool PackedChunks::is_of(const Head& head, std::size_t chunk) const {
  const auto column = std::int32_t(chunk % std::size_t(columns_)),
             row = std::int32_t(chunk / std::size_t(columns_));
  return head.part == &part_ && head.is_full_resolution() &&
         head.x == (is_tiled(part_) ? column : 0) &&
         head.y == (is_tiled(part_) ? row : window(chunk).y0);
}

/// In a file of one part OpenEXR does not look up where the chunk of scanlines is that comes after
/// the one it has just read: it takes what stands next in the file.
/// Source: OpenEXR 3.1, ImfScanLineInputFile.cpp and ImfDeepScanLineInputFile.cpp, readPixelData().
void PackedChunks::check_is_next(std::size_t chunk, std::size_t most) const {
  if (is_tiled(part_) || is_multi_part(file_)) return;
  const bool down = part_.header.lineOrder() == Imf::INCREASING_Y;
  if (chunk == (down ? 0 : count() - 1)) return;
  const std::size_t before = down ? chunk - 1 : chunk + 1;
  const Head head = head_of(before);
  const bool is_readable = is_of(head, before) && head.bytes <= most;
  if (is_readable && places_[chunk] != 0 && places_[chunk] != head.end())
    throw std::runtime_error("a chunk does not stand after the one before it");
}

}  // namespace ssdo
