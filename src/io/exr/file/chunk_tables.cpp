// SPDX-License-Identifier: Apache-2.0
#include "io/exr/file/chunk_tables.h"

#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfVersion.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "io/exr/file/exr_parts.h"

namespace ssdo {
namespace {

/// Reads numbers that stand one after another, little endian; 0 where the file ends.
class NumberReader {
 public:
  NumberReader(const InputFile& file, std::uint64_t place, std::size_t bytes) : bytes_(bytes) {
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

/// Most bytes of the head of a chunk: part, column, row, two levels, and two sizes of eight bytes.
constexpr std::size_t kHeadBytes = 5 * 4 + 2 * 8;

std::uint64_t divide_up(std::uint64_t a, std::uint64_t b) { return (a + b - 1) / b; }

/// The numbers of tiles along one side at each level, where `largest` is the side that the levels
/// halve down to one pixel.
std::vector<std::uint64_t> tiles_of_levels(std::uint64_t side, std::uint64_t tile,
                                           std::uint64_t largest, const Imf::TileDescription& how) {
  const auto at_level = [&](std::uint64_t pixels, int level) {
    const std::uint64_t step = std::uint64_t(1) << level;
    return std::max(std::uint64_t(1),
                    how.roundingMode == Imf::ROUND_UP ? divide_up(pixels, step) : pixels / step);
  };
  std::vector<std::uint64_t> tiles = {divide_up(side, tile)};
  for (int level = 1; how.mode != Imf::ONE_LEVEL && at_level(largest, level - 1) > 1; ++level)
    tiles.push_back(divide_up(at_level(side, level), tile));
  return tiles;
}

bool is_mip_mapped(const ExrPart& part) {
  return part.header.tileDescription().mode == Imf::MIPMAP_LEVELS;
}

/// The largest size of a flat chunk; OpenEXR reads larger ones as negative numbers.
constexpr std::uint64_t kMostBytes = std::numeric_limits<std::int32_t>::max();

}  // namespace

ChunkTables::ChunkTables(const InputFile& input, const Imf::MultiPartInputFile& file,
                         std::span<const ExrPart> all, std::uint64_t begin)
    : input_(input), is_multi_part_(Imf::isMultiPart(file.version())), all_(all) {
  for (const ExrPart& part : all) {
    parts_.push_back(describe(part, begin));
    begin += 8 * parts_.back().count;
  }
  if (!std::ranges::all_of(all, [&](const ExrPart& part) { return is_complete(part); }))
    search(begin);
}

bool ChunkTables::is_complete(const ExrPart& part) const {
  const std::uint64_t count = of(part).count;
  // Not by places(): a header may claim more of them than memory holds.
  NumberReader numbers(
      input_, of(part).begin,
      sizeof(std::uint64_t) * std::min(count, input_.bytes() / sizeof(std::uint64_t)));
  for (std::uint64_t i = 0; i < count; ++i)
    if (std::int64_t(numbers.next<std::uint64_t>()) <= 0) return false;
  return true;
}

std::vector<std::uint64_t> ChunkTables::places(const ExrPart& part) const {
  std::vector<std::uint64_t> places(of(part).count);
  NumberReader numbers(input_, of(part).begin,
                       std::min(sizeof(std::uint64_t) * places.size(), input_.bytes()));
  for (std::uint64_t& place : places) place = numbers.next<std::uint64_t>();
  return places;
}

ChunkHead ChunkTables::head_at(std::uint64_t place) const {
  NumberReader numbers(input_, place, kHeadBytes);
  const std::size_t part = is_multi_part_ ? numbers.next<std::uint32_t>() : 0;
  if (part >= all_.size()) return {};
  ChunkHead head{&all_[part]};
  if (is_tiled(*head.part)) head.x = std::int32_t(numbers.next<std::uint32_t>());
  head.y = std::int32_t(numbers.next<std::uint32_t>());
  if (is_tiled(*head.part)) {
    head.x_level = std::int32_t(numbers.next<std::uint32_t>());
    head.y_level = std::int32_t(numbers.next<std::uint32_t>());
  }
  if (!numbers.are_all()) return {};
  if (head.part->deep) {
    head.bytes = numbers.next<std::uint64_t>();
    head.samples = numbers.next<std::uint64_t>();
  } else {
    head.bytes = numbers.next<std::uint32_t>();
  }
  head.has_sizes = numbers.are_all();
  // The sizes of a deep chunk are followed by the size of its samples when unpacked.
  head.place = place + numbers.taken() + (head.part->deep ? sizeof(std::uint64_t) : 0);
  return head;
}

/// Describes the table of a part, all levels included. A part whose type OpenEXR does not know
/// states its number of chunks itself.
ChunkTables::OfPart ChunkTables::describe(const ExrPart& part, std::uint64_t begin) {
  OfPart of{begin, 0, {}, {}, {}};
  const auto width = std::uint64_t(part.data_window.width()),
             height = std::uint64_t(part.data_window.height());
  if (!Imf::isSupportedType(part.header.type())) {
    of.count = std::uint64_t(part.header.chunkCount());
  } else if (!is_tiled(part)) {
    of.count = divide_up(height, std::uint64_t(lines_per_chunk(part.header.compression())));
  } else {
    const Imf::TileDescription& tile = part.header.tileDescription();
    const std::uint64_t largest = std::max(width, height);
    const bool mipmap = is_mip_mapped(part);
    of.columns = tiles_of_levels(width, tile.xSize, mipmap ? largest : width, tile);
    of.rows = tiles_of_levels(height, tile.ySize, mipmap ? largest : height, tile);
    const auto sum = [](const std::vector<std::uint64_t>& tiles) {
      return std::accumulate(tiles.begin(), tiles.end(), std::uint64_t(0));
    };
    of.count = mipmap ? std::inner_product(of.columns.begin(), of.columns.end(), of.rows.begin(),
                                           std::uint64_t(0))
                      : sum(of.columns) * sum(of.rows);
  }
  return of;
}

/// Stops where OpenEXR does: at a chunk that its part does not have, which is left out, or at a
/// chunk without valid sizes, which is still recorded.
void ChunkTables::search(std::uint64_t first) {
  std::uint64_t chunks = 0;
  for (const OfPart& part : parts_) chunks += part.count;
  for (std::uint64_t next = first; chunks > 0; --chunks) {
    const ChunkHead head = head_at(next);
    if (!head.part || !has_chunk(head)) return;
    parts_[std::size_t(head.part->index)].found.push_back(next);
    const bool is_size = head.has_sizes && (head.part->deep || head.bytes <= kMostBytes);
    if (!is_size || head.end() <= next) return;
    next = head.end();
  }
}

/// Whether the part has such a scanline or tile. For the rows of a mip map, OpenEXR uses the level
/// of the columns.
bool ChunkTables::has_chunk(const ChunkHead& head) const {
  const ExrPart& part = *head.part;
  if (!is_tiled(part)) return head.y >= part.data_window.y0 && head.y < part.data_window.y1;
  if (std::min({head.x, head.y, head.x_level, head.y_level}) < 0) return false;
  const auto &columns = of(part).columns, &rows = of(part).rows;
  const auto across = std::size_t(head.x_level), down = std::size_t(head.y_level);
  return across < columns.size() && down < rows.size() && std::uint64_t(head.x) < columns[across] &&
         std::uint64_t(head.y) < rows[is_mip_mapped(part) ? across : down];
}

}  // namespace ssdo
