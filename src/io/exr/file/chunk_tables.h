// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "io/exr/file/exr_parts.h"
#include "io/files/input_file.h"

namespace ssdo {

/// The numbers before the bytes of a chunk. A search of OpenEXR records the chunk as soon as it has
/// read where in the part the chunk belongs.
struct ChunkHead {
  const ExrPart* part = nullptr;  ///< none: there is no chunk
  std::int32_t x = 0, y = 0;      ///< the column and row of a tile, or the first scanline
  std::int32_t x_level = 0, y_level = 0;
  bool has_sizes = false;     ///< the file does not end before them
  std::uint64_t bytes = 0;    ///< of a flat chunk, or of a deep one's table of sample counts
  std::uint64_t samples = 0;  ///< the bytes of a deep chunk's samples, which follow
  std::uint64_t place = 0;    ///< where the bytes begin

  std::uint64_t end() const { return place + bytes + samples; }  ///< modulo 2^64
  bool is_full_resolution() const { return x_level == 0 && y_level == 0; }
};

/// The tables of where the chunks of all parts begin, which follow the headers. If any table lacks
/// a place, OpenEXR searches for the chunks of all parts, going from one chunk to the next.
/// Source: OpenEXR file layout, "Chunk Offset Table"; OpenEXR 3.1, ImfMultiPartInputFile.cpp,
/// chunkOffsetReconstruction().
class ChunkTables {
 public:
  /// The tables of a file and its parts, which have to live as long as this object. `begin` is
  /// where the tables begin, in bytes.
  ChunkTables(const InputFile& input, const Imf::MultiPartInputFile& file,
              std::span<const ExrPart> all, std::uint64_t begin);

  /// Whether the table of a part has a place for each chunk, as partComplete() of OpenEXR 3.1 says;
  /// in 3.4 that function also counts the chunks that a search has found.
  bool is_complete(const ExrPart& part) const;

  /// What the table of a part says: full resolution first, 0 for a chunk that is missing.
  std::vector<std::uint64_t> places(const ExrPart& part) const;

  /// The places where a search of OpenEXR finds chunks of a part, in this order; of two places for
  /// the same scanline or tile, OpenEXR takes the last.
  std::span<const std::uint64_t> found(const ExrPart& part) const { return of(part).found; }

  ChunkHead head_at(std::uint64_t place) const;

 private:
  struct OfPart {
    std::uint64_t begin;                       ///< of the table, in bytes
    std::uint64_t count;                       ///< of places in it
    std::vector<std::uint64_t> columns, rows;  ///< of the tiles at each level
    std::vector<std::uint64_t> found;
  };

  static OfPart describe(const ExrPart& part, std::uint64_t begin);
  const OfPart& of(const ExrPart& part) const { return parts_[std::size_t(part.index)]; }
  void search(std::uint64_t first);
  bool has_chunk(const ChunkHead& head) const;

  const InputFile& input_;
  bool is_multi_part_;
  std::span<const ExrPart> all_;
  std::vector<OfPart> parts_;
};

}  // namespace ssdo
