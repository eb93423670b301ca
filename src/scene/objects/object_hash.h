// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace ssdo {

/// MurmurHash3_x86_32 of Austin Appleby with the seed 0.
std::uint32_t murmur3_32(std::string_view text);

/// The bits of the float that stands for a name in a Cryptomatte: its hash, with the lowest bit of
/// the exponent flipped where that is 0 or 255, so that no id is a denormal, infinite or NaN
/// (Friedman and Jones, Cryptomatte specification 1.2.0, "uint32_to_float32").
std::uint32_t cryptomatte_id(std::string_view name);

}  // namespace ssdo
