// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "io/exr/file/chunk_tables.h"
#include "io/exr/file/exr_file.h"

namespace ssdo {

/// The chunks of a part as they are packed in the file: scanlines from the top, or the tiles of the
/// full resolution row by row. OpenEXR gives chunks of tiles in the order of the file only.
/// Source: OpenEXR file layout, "Chunk Offset Table" and "Pixel data".
class PackedChunks {
 public:
  /// `file` and `part` have to live as long as this object. Throws std::runtime_error for a part of
  /// a type that OpenEXR does not read.
  PackedChunks(const ExrFile& file, const ExrPart& part);

  std::size_t count() const { return std::size_t(columns_) * std::size_t(rows_); }
  int columns() const { return columns_; }  ///< 1 for scanlines

  /// The chunks that hold rows [y0, y1) of the data window: the first, and one past the last.
  std::size_t first(int y0) const;
  std::size_t end(int y1) const;

  /// The part of the data window that a chunk holds.
  Window window(std::size_t chunk) const;

  /// The bytes of a chunk; of a deep part, those of its table of sample counts. From any thread.
  /// Throws std::runtime_error where the chunk is missing, cut short or larger than `most` bytes,
  /// and where OpenEXR would take other bytes for it than those at its place.
  std::vector<std::byte> read(std::size_t chunk, std::size_t most) const;

  /// Throws std::runtime_error where a tile of a smaller level is cut short or larger than `most`
  /// bytes.
  void check_smaller_levels(std::size_t most) const;

 private:
  void add_place(std::uint64_t found);
  ChunkHead head_of(std::size_t chunk) const;
  bool is_of(const ChunkHead& head, std::size_t chunk) const;
  void check_size(const ChunkHead& head, std::size_t most) const;
  void check_is_next(std::size_t chunk, std::size_t most) const;

  const ExrFile& file_;
  const ExrPart& part_;
  int width_, height_;  ///< of a chunk, in pixels
  int columns_, rows_;  ///< of chunks
  const ChunkTables& tables_;
  std::uint64_t size_;                 ///< of the file, in bytes
  std::vector<std::uint64_t> places_;  ///< of the chunks, then of all tiles of smaller levels
};

}  // namespace ssdo
