// SPDX-License-Identifier: Apache-2.0
#include "io/exr/compression.h"

#include <algorithm>

namespace ssdo {

bool is_lossy(Imf::Compression compression) {
  switch (compression) {
    case Imf::PXR24_COMPRESSION:
    case Imf::B44_COMPRESSION:
    case Imf::B44A_COMPRESSION:
    case Imf::DWAA_COMPRESSION:
    case Imf::DWAB_COMPRESSION:
      return true;
    default:
      return false;
  }
}

void set_level(Imf::Header& header, int level) {
  constexpr int kMostOfZlib = 9;  // with which OpenEXR packs ZIP and ZIPS
  if (is_lossy(header.compression()))
    header.dwaCompressionLevel() = float(level);
  else
    header.zipCompressionLevel() = std::min(level, kMostOfZlib);
}

}  // namespace ssdo
