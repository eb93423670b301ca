// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "io/exr/chunks/missing_chunks.h"
#include "io/exr/file/exr_file.h"

namespace ssdo {

/// Where the values of a channel go, row by row over some rows of its part's data window.
struct ChannelRows {
  ExrChannel channel;
  std::byte* pixels;
  bool as_float;  ///< half becomes float; else as stored
};

/// Tries every chunk of a part.
MissingChunks find_missing_chunks(const ExrFile& file, const ExrPart& part);

/// Has OpenEXR read `rows` of channels of a flat part, which are its data window or some rows of
/// it, but for the chunks in `missing`, whose pixels stay as they are. Errors: those of
/// check_chunk_sizes() and of OpenEXR.
void read_chunks(const ExrFile& file, const ExrPart& part, const Window& rows,
                 std::span<const ChannelRows> channels, const MissingChunks& missing = {});

}  // namespace ssdo
