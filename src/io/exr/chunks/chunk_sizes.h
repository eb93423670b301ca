// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/exr/chunks/missing_chunks.h"
#include "io/exr/file/exr_file.h"

namespace ssdo {

class PackedChunks;

/// Throws std::runtime_error where a chunk of a part unpacks to fewer bytes than its pixels take,
/// as where a header claims wider rows or larger tiles than were written. Of a deep part, the
/// tables of sample counts are looked at. OpenEXR checks this for some compressions only, and
/// leaves the other pixels as they were in memory. Also throws what PackedChunks::read() does.
void check_chunk_size(const ExrPart& part, const PackedChunks& chunks, std::size_t chunk);

/// The same for all chunks that hold `rows` of the data window, but for those in `missing`.
void check_chunk_sizes(const ExrFile& file, const ExrPart& part, const Window& rows,
                       const MissingChunks& missing = {});

/// Throws std::runtime_error where a tile of a smaller level of a part is cut short or claims more
/// bytes than a tile's pixels take.
void check_smaller_levels(const ExrFile& file, const ExrPart& part);

}  // namespace ssdo
