// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <istream>
#include <string>

#include "error.h"

namespace ssdo {

/// Deflate packs 1032:1 at best, and DWAA deflates the one coefficient that is left of a constant
/// block of 64 pixels: no codec goes further than their product, 66048:1 in half, twice in float.
inline constexpr double kLargestRatio = 1 << 18;

/// Memory of the machine, in bytes.
double physical_memory();

/// Set and return the bytes that the run may use (--mem-limit); by default the machine's memory.
void limit_memory(double bytes);
double memory_limit();

/// Refuses to allocate what a damaged header claims. Throws ExitCode::input if `pixel_bytes`, all
/// decoded pixels, are more than a file of `file_bytes` can hold at `largest_ratio`, or if
/// `needed_bytes`, what is about to be allocated, exceeds the machine's memory.
void check_decoded_size(const std::filesystem::path& file, std::uint64_t file_bytes,
                        double pixel_bytes, double needed_bytes,
                        double largest_ratio = kLargestRatio);

/// The same for a picture or map. It is not read in bands, so `needed_bytes` may not exceed
/// memory_limit() either.
void check_picture_size(const std::filesystem::path& file, double pixel_bytes, double needed_bytes);

/// Refuses a text of more than `most` bytes before a parser takes it in. Throws `code`.
void check_text_size(const std::filesystem::path& file, std::size_t most, ExitCode code);

/// All of `in`, which reads `file`; that may be a pipe without an end. Errors: those of
/// check_text_size().
std::string read_text(std::istream& in, const std::filesystem::path& file, std::size_t most,
                      ExitCode code);

}  // namespace ssdo
