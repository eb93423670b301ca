// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace ssdo::fuzz {

/// The bytes of pixels in the data of a chunk, by the number that compressions have in files;
/// nothing for compressions other than none, RLE, ZIPS and ZIP, and for what is not packed.
std::optional<std::string> unpack(int compression, const std::string& data);

/// The data of a chunk for them: as they are where they would not get smaller.
std::string pack(int compression, const std::string& pixels);

}  // namespace ssdo::fuzz
