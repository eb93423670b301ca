// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "io/exr/exr_reader.h"

namespace ssdo {

/// Where the values of a channel go, row by row over some rows of its part's data window.
struct ChannelRows {
  ExrChannel channel;
  std::byte* pixels;
  bool as_float;  ///< half becomes float; else as stored
};

/// Tries every chunk of a part.
MissingChunks find_missing_chunks(const ExrReader& file, const ExrPart& part);

/// Whether a chunk, of this window, is among them.
bool is_missing(const MissingChunks& missing, const Window& chunk);

/// "12 of 36 rows are missing or damaged, between rows 16 and 31"; of a tiled part, tiles are
/// counted.
std::string describe(const MissingChunks& missing, const ExrPart& part);

/// Has OpenEXR read `rows` of channels of a flat part, which are its data window or some rows of
/// it, but for the chunks in `missing`, whose pixels stay as they are. Errors: those of
/// check_chunk_sizes() and of OpenEXR.
void read_chunks(const ExrReader& file, const ExrPart& part, const Window& rows,
                 std::span<const ChannelRows> channels, const MissingChunks& missing = {});

}  // namespace ssdo
