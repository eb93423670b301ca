// SPDX-License-Identifier: Apache-2.0
#include "io/exr/chunks/chunk_sizes.h"

#include <libdeflate.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <stdexcept>

#include "io/exr/chunks/dwa_chunk.h"
#include "io/exr/chunks/packed_chunks.h"
#include "io/exr/file/exr_parts.h"
#include "parallel/tiles.h"

namespace ssdo {
namespace {

using Bytes = std::span<const std::byte>;

/// How many whole numbers from `begin` on and before `end` are multiples of `step`.
std::size_t multiples(std::int64_t begin, std::int64_t end, std::int64_t step) {
  const auto floor = [step](std::int64_t n) { return n >= 0 ? n / step : ~(~n / step); };
  return std::size_t(floor(end - 1) - floor(begin - 1));
}

/// What a chunk of a flat part unpacks to.
std::size_t pixel_bytes(const ExrPart& part, const Window& chunk) {
  std::size_t bytes = 0;
  for (const ExrChannel& c : part.channels) {
    bytes += multiples(chunk.x0, chunk.x1, c.x_sampling) *
             multiples(chunk.y0, chunk.y1, c.y_sampling) * bytes_of(c.type);
  }
  return bytes;
}

/// The inflated size; `most` if `packed` is damaged or exceeds it, which OpenEXR reports itself.
std::size_t inflated_bytes(Bytes packed, std::size_t most) {
  const auto inflated = std::make_unique_for_overwrite<std::byte[]>(most);
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> inflate(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  if (!inflate) throw std::bad_alloc();
  std::size_t size = 0;
  const libdeflate_result result = libdeflate_zlib_decompress(
      inflate.get(), packed.data(), packed.size(), inflated.get(), most, &size);
  return result == LIBDEFLATE_SUCCESS ? size : most;
}

/// Size of unpacked runs. A run is a count n >= 0 and a byte that is repeated n + 1 times, or -n
/// and n bytes.
std::size_t bytes_of_runs(Bytes packed) {
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < packed.size();) {
    const int count = static_cast<signed char>(packed[i]);
    bytes += std::size_t(count < 0 ? -count : count + 1);
    i += std::size_t(count < 0 ? 1 - count : 2);
  }
  return bytes;
}

/// Whether a chunk of DWAA or DWAB holds all its pixels, of the channels that are deflated, stored
/// as runs, or transformed in blocks of 8 x 8. OpenEXR decodes as much of each as there is, and
/// does not compare this with the number of pixels.
bool holds_dwa_pixels(const ExrPart& part, const Window& chunk, Bytes packed) {
  const auto dwa = read_dwa_chunk(packed);
  if (!dwa) return false;
  std::size_t deflated = 0, runs = 0, blocks = 0;
  for (const ExrChannel& c : part.channels) {
    const std::size_t columns = multiples(chunk.x0, chunk.x1, c.x_sampling),
                      rows = multiples(chunk.y0, chunk.y1, c.y_sampling),
                      bytes = columns * rows * bytes_of(c.type);
    switch (scheme_of(c, dwa->rules)) {
      case DwaScheme::deflated:
        deflated += bytes;
        break;
      case DwaScheme::transformed:
        blocks += (columns + 7) / 8 * ((rows + 7) / 8);
        break;
      case DwaScheme::runs:
        runs += bytes;
        break;
    }
  }
  return dwa->runs == runs && dwa->blocks == blocks && (blocks == 0 || dwa->has_coefficients) &&
         (deflated == 0 ||
          (!dwa->deflated.empty() && inflated_bytes(dwa->deflated, deflated) == deflated));
}

/// The unpacked size of a chunk, or `most` where OpenEXR checks it: PXR24 and B44 give an error,
/// and PIZ is decoded to as many values as there are pixels.
std::size_t unpacked_bytes(const ExrPart& part, const Window& chunk, Bytes packed,
                           std::size_t most) {
  if (packed.empty() || packed.size() >= most) return packed.size();
  switch (part.header.compression()) {
    case Imf::NO_COMPRESSION:
      return packed.size();
    case Imf::RLE_COMPRESSION:
      return bytes_of_runs(packed);
    case Imf::ZIPS_COMPRESSION:
    case Imf::ZIP_COMPRESSION:
      return inflated_bytes(packed, most);
    case Imf::DWAA_COMPRESSION:
    case Imf::DWAB_COMPRESSION:
      return holds_dwa_pixels(part, chunk, packed) ? most : 0;
    default:
      return most;
  }
}

/// The most bytes of a chunk, or of a table of counts: those of a whole tile, even one that the
/// image fills in part, and no more than an int, in which OpenEXR's decoders count bytes.
std::size_t most_packed(const ExrPart& part) {
  constexpr double kMost = std::numeric_limits<std::int32_t>::max();
  const double pixel = part.deep ? sizeof(std::uint32_t) : bytes_per_pixel(part);
  return std::size_t(std::min(pixel * pixels_per_chunk(part), kMost));
}

}  // namespace

void check_chunk_size(const ExrPart& part, const PackedChunks& chunks, std::size_t chunk) {
  const Window window = chunks.window(chunk);
  const std::size_t most = most_packed(part),
                    taken = part.deep ? sizeof(std::uint32_t) * window.area()
                                      : pixel_bytes(part, window),
                    room = part.deep ? most : taken;
  if (unpacked_bytes(part, window, chunks.read(chunk, most), room) < taken)
    throw std::runtime_error("a chunk holds fewer bytes than its pixels take");
}

void check_chunk_sizes(const ExrFile& file, const ExrPart& part, const Window& rows,
                       const MissingChunks& missing) {
  const PackedChunks chunks(file, part);
  const std::size_t first = chunks.first(rows.y0);
  std::vector<std::exception_ptr> errors(chunks.end(rows.y1) - first);
  for_each_task(errors.size(), [&](std::size_t i) {
    if (is_missing(missing, chunks.window(first + i))) return;
    try {
      check_chunk_size(part, chunks, first + i);
    } catch (...) {
      errors[i] = std::current_exception();
    }
  });
  // The error of the first damaged chunk, whichever thread comes first.
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

void check_smaller_levels(const ExrFile& file, const ExrPart& part) {
  PackedChunks(file, part).check_smaller_levels(most_packed(part));
}

}  // namespace ssdo
