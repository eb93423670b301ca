// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ImfCompression.h>
#include <ImfHeader.h>

namespace ssdo {

/// Whether pixels come back changed.
bool is_lossy(Imf::Compression compression);

/// Has OpenEXR pack with a level of the header's compression, which has to have levels; ZIP and
/// ZIPS take those above 9 for 9. No file says what its level was.
void set_level(Imf::Header& header, int level);

}  // namespace ssdo
