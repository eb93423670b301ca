// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "fuzz/chance.h"
#include "fuzz/exr_sample.h"

namespace ssdo::fuzz {

/// Another EXR that resembles `bytes`: with an attribute, a channel, a window or the pixels of a
/// chunk changed and everything around kept valid, so that readers get as far as before; now and
/// then with any bytes changed, or a new sample of one of `kinds`.
std::string mutated_exr(const std::string& bytes, const std::vector<ExrKind>& kinds,
                        std::size_t most_bytes, Chance& chance);

/// The same for libFuzzer: changes `size` bytes in a place with room for `most_bytes`; returns how
/// many there are then.
std::size_t mutate_exr(std::uint8_t* bytes, std::size_t size, std::size_t most_bytes,
                       const std::vector<ExrKind>& kinds, unsigned seed);

}  // namespace ssdo::fuzz
