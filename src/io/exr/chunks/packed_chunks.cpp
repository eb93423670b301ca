// SPDX-License-Identifier: Apache-2.0
#include "io/exr/chunks/packed_chunks.h"

#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfVersion.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "io/exr/file/exr_parts.h"

namespace ssdo {
namespace {

/// In place of the offset of a chunk that is found in several places.
constexpr std::uint64_t kNowhere = ~std::uint64_t(0);

}  // namespace

PackedChunks::PackedChunks(const ExrFile& file, const ExrPart& part)
    : file_(file),
      part_(part),
      width_(part.data_window.width()),
      height_(lines_per_chunk(part.header.compression())),
      tables_(file.chunk_tables()),
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
  places_ = tables_.places(part);
  for (const std::uint64_t place : tables_.found(part)) add_place(place);
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
  const ChunkHead head = head_of(chunk);
  if (!head.part) throw std::runtime_error("a chunk is missing or cut short");
  if (!is_of(head, chunk)) throw std::runtime_error("a chunk stands in the place of another");
  check_size(head, most);
  std::vector<std::byte> bytes(head.bytes);
  if (file_.input().read(head.place, bytes) < bytes.size())
    throw std::runtime_error("a chunk is cut short");
  return bytes;
}

void PackedChunks::check_smaller_levels(std::size_t most) const {
  for (std::size_t i = count(); i < places_.size(); ++i) {
    const ChunkHead head = places_[i] == 0 ? ChunkHead() : tables_.head_at(places_[i]);
    if (head.part == &part_) check_size(head, most);  // OpenEXR refuses all others
  }
}

/// OpenEXR allocates the bytes that a chunk claims before it finds that the file ends earlier: this
/// check comes first.
void PackedChunks::check_size(const ChunkHead& head, std::size_t most) const {
  if (head.bytes > most) throw std::runtime_error("a chunk claims more bytes than its pixels take");
  if (!head.has_sizes || head.place > size_ || head.bytes > size_ - head.place ||
      head.samples > size_ - head.place - head.bytes)
    throw std::runtime_error("a chunk is cut short");
  // OpenEXR counts the bytes of a deep chunk, including its head, in an int.
  constexpr std::size_t kHead = 40, kMost = std::numeric_limits<std::int32_t>::max() - kHead;
  if (head.samples > 0 && head.bytes + head.samples > kMost)
    throw std::runtime_error("a chunk is larger than 2 GiB");
}

/// Counts a chunk that a search of the file has found. A tile of a smaller level adds one more
/// place to check.
void PackedChunks::add_place(std::uint64_t found) {
  const ChunkHead head = tables_.head_at(found);
  if (!head.is_full_resolution()) return places_.push_back(found);
  const std::int64_t row =
      is_tiled(part_) ? head.y : (std::int64_t(head.y) - part_.data_window.y0) / height_;
  // The file may have changed since the search.
  if (head.x < 0 || head.x >= columns_ || row < 0 || row >= rows_) return;
  std::uint64_t& place = places_[std::size_t(row) * std::size_t(columns_) + std::size_t(head.x)];
  place = place == 0 || place == found ? found : kNowhere;
}

ChunkHead PackedChunks::head_of(std::size_t chunk) const {
  return places_[chunk] == 0 ? ChunkHead() : tables_.head_at(places_[chunk]);
}

bool PackedChunks::is_of(const ChunkHead& head, std::size_t chunk) const {
  const auto column = std::int32_t(chunk % std::size_t(columns_)),
             row = std::int32_t(chunk / std::size_t(columns_));
  return head.part == &part_ && head.is_full_resolution() &&
         head.x == (is_tiled(part_) ? column : 0) &&
         head.y == (is_tiled(part_) ? row : window(chunk).y0);
}

/// In a file of one part, OpenEXR does not look up the place of the next chunk of scanlines: after
/// one chunk it reads whatever follows in the file.
/// Source: OpenEXR 3.1, ImfScanLineInputFile.cpp and ImfDeepScanLineInputFile.cpp, readPixelData().
void PackedChunks::check_is_next(std::size_t chunk, std::size_t most) const {
  if (is_tiled(part_) || Imf::isMultiPart(file_.file().version())) return;
  const bool down = part_.header.lineOrder() == Imf::INCREASING_Y;
  if (chunk == (down ? 0 : count() - 1)) return;
  const std::size_t before = down ? chunk - 1 : chunk + 1;
  const ChunkHead head = head_of(before);
  const bool is_readable = is_of(head, before) && head.has_sizes && head.bytes <= most;
  if (is_readable && places_[chunk] != 0 && places_[chunk] != head.end())
    throw std::runtime_error("a chunk does not stand after the one before it");
}

}  // namespace ssdo
