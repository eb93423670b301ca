// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfCompression.h>

#include <bit>

// A chunk of ZIP holds 16 scanlines, one of ZIPS a single one; the channels of a line follow each
// other in the order of the header. Before it is deflated, the bytes of the whole chunk with even
// places are put before those with odd ones, and each byte but the first is replaced by its
// difference to the one before, plus 128. A chunk that would not get smaller is stored as it is.
// (OpenEXR file layout; Technical Introduction to OpenEXR, "Data Compression".)

namespace ssdo {

/// Whether chunks of this compression are as above, and the machine has the byte order of files.
constexpr bool is_zip(Imf::Compression compression) {
  return std::endian::native == std::endian::little &&
         (compression == Imf::ZIP_COMPRESSION || compression == Imf::ZIPS_COMPRESSION);
}

}  // namespace ssdo
