// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "io/exr/exr_reader.h"

namespace ssdo {

/// Where the values of a channel go, row by row over the data window of its part.
struct ChannelRows {
  ExrChannel channel;
  std::byte* pixels;
  bool as_float;  ///< half becomes float; else as stored
};

/// Reads channels of a part whose scanlines are packed with ZIP or ZIPS: libdeflate inflates chunks
/// side by side, and only these channels are unpacked. The bits are those of OpenEXR's own reader,
/// in less than half of its time.
///
/// Returns false, with some pixels written or none, where that reader has to be asked: a part or a
/// channel of another kind, or a damaged chunk, which it has a message for.
bool read_zip_lines(Imf::MultiPartInputFile& file, const ExrPart& part,
                    std::span<const ChannelRows> channels);

}  // namespace ssdo
