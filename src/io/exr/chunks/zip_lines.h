// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "io/exr/chunks/exr_chunks.h"

namespace ssdo {

/// Reads rows of channels of a part whose scanlines are packed with ZIP or ZIPS: libdeflate
/// inflates chunks side by side, and only these channels are unpacked. The bits are those of
/// OpenEXR's own reader, in less than half of its time.
///
/// `rows` is the part's data window, or some rows of it. Returns false, perhaps with some pixels
/// written, where OpenEXR's reader is needed: for a part or channel of another kind, or for a
/// damaged chunk, of which OpenEXR has an error message.
bool read_zip_lines(const ExrFile& file, const ExrPart& part, const Window& rows,
                    std::span<const ChannelRows> channels);

}  // namespace ssdo
