// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "io/exr/file/exr_parts.h"

namespace ssdo {

/// The chunks of a part that are cut off, were never written, or cannot be decoded.
struct MissingChunks {
  std::vector<Window> windows;  ///< the rows or full-resolution tiles, from the top left
  std::size_t count = 0;        ///< of all chunks, sound ones too
};

/// Whether `missing` contains the chunk that covers the window `chunk`.
bool is_missing(const MissingChunks& missing, const Window& chunk);

/// "12 of 36 rows are missing or damaged, between rows 16 and 31"; of a tiled part, tiles are
/// counted.
std::string describe(const MissingChunks& missing, const ExrPart& part);

}  // namespace ssdo
